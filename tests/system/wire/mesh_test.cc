// Meshes over the wire: registration, sharing, every fault of a mesh, quotas.
#include <functional>
#include <limits>

#include "tests/system/wire/wire_fixture.h"

namespace arap::wire {
namespace {

class MeshTest : public WireTest {
 protected:
  void SetUp() override { ASSERT_TRUE(CreateSession("s").ok()); }

  grpc::Status Get(const std::string& mesh, v1::GetMeshResponse* response) {
    v1::GetMeshRequest request;
    request.set_session_id("s");
    request.set_mesh_id(mesh);
    return Call(&Deformation::GetMesh, request, response);
  }

  grpc::Status RegisterWith(const v1::EnergyOptions& energy) {
    v1::RegisterMeshRequest request;
    request.set_session_id("s");
    *request.mutable_mesh() = Grid(2, 2);
    *request.mutable_energy() = energy;
    v1::RegisterMeshResponse response;
    return Call(&Deformation::RegisterMesh, request, &response);
  }
};

TEST_F(MeshTest, RegisterAnswersWhatTheMeshIs) {
  v1::RegisterMeshResponse response;
  ASSERT_TRUE(Register("s", "m", Grid(4, 3), &response).ok());
  const v1::MeshInfo& mesh = response.mesh();
  EXPECT_EQ(mesh.mesh_id(), "m");
  EXPECT_EQ(mesh.content_hash().size(), 64u);
  EXPECT_EQ(mesh.vertex_count(), 20u);
  EXPECT_EQ(mesh.triangle_count(), 24u);
  EXPECT_EQ(mesh.edge_count(), 43u);
  EXPECT_EQ(mesh.component_count(), 1u);
  EXPECT_EQ(mesh.boundary_loop_count(), 1u);
  EXPECT_DOUBLE_EQ(mesh.area(), 12);
  EXPECT_DOUBLE_EQ(mesh.diagonal(), 5);
  EXPECT_GT(mesh.bytes(), 0u);
  EXPECT_EQ(mesh.energy().basis(), v1::BASIS_EDGE);
  EXPECT_EQ(mesh.energy().weights(), v1::EDGE_WEIGHTS_UNIFORM);
  EXPECT_FALSE(response.shared());
  EXPECT_GT(response.solve_time().nanos(), 0);

  v1::GetMeshResponse known;
  ASSERT_TRUE(Get("m", &known).ok());
  EXPECT_EQ(known.mesh().SerializeAsString(), mesh.SerializeAsString());
}

TEST_F(MeshTest, DefaultIdIsTheContentHash) {
  v1::RegisterMeshResponse response;
  ASSERT_TRUE(Register("s", "", Grid(2, 2), &response).ok());
  EXPECT_EQ(response.mesh().mesh_id(), response.mesh().content_hash().substr(0, 32));
}

TEST_F(MeshTest, EqualMeshesShareTheirFactors) {
  v1::RegisterMeshResponse first;
  v1::RegisterMeshResponse second;
  ASSERT_TRUE(Register("s", "m", Grid(2, 2), &first).ok());
  ASSERT_TRUE(CreateSession("t").ok());
  ASSERT_TRUE(Register("t", "n", Grid(2, 2), &second).ok());
  EXPECT_FALSE(first.shared());
  EXPECT_TRUE(second.shared());
  EXPECT_EQ(first.mesh().content_hash(), second.mesh().content_hash());
}

TEST_F(MeshTest, RepeatingRegistrationIsHarmlessAndIdsAreNotReused) {
  ASSERT_TRUE(Register("s", "m", Grid(2, 2)).ok());
  v1::RegisterMeshResponse again;
  ASSERT_TRUE(Register("s", "m", Grid(2, 2), &again).ok());
  EXPECT_TRUE(again.shared());
  ExpectError(Register("s", "m", Grid(3, 2)), grpc::ALREADY_EXISTS, "ALREADY_EXISTS");
  EXPECT_TRUE(Register("s", "n", Grid(3, 2)).ok());
}

TEST_F(MeshTest, DeletingForgetsTheHandleSetsOnIt) {
  ASSERT_TRUE(Register("s", "m", Grid(2, 2)).ok());
  ASSERT_TRUE(Compile("s", "m", "h", {VertexHandle("a", 0)}).ok());
  v1::DeleteMeshRequest request;
  request.set_session_id("s");
  request.set_mesh_id("m");
  v1::DeleteMeshResponse response;
  ASSERT_TRUE(Call(&Deformation::DeleteMesh, request, &response).ok());
  ExpectError(Call(&Deformation::DeleteMesh, request, &response), grpc::NOT_FOUND, "NOT_FOUND");
  v1::GetMeshResponse known;
  ExpectError(Get("m", &known), grpc::NOT_FOUND, "NOT_FOUND");
  ExpectError(Deform("s", "h", {TargetAt("a", 0, 0)}), grpc::NOT_FOUND, "NOT_FOUND");
}

TEST_F(MeshTest, UnknownSessionOrBadNameIsRefused) {
  ExpectError(Register("t", "m", Grid(2, 2)), grpc::NOT_FOUND, "NOT_FOUND");
  const auto error =
      ExpectError(Register("s", "m/1", Grid(2, 2)), grpc::INVALID_ARGUMENT, "INVALID_NAME");
  EXPECT_EQ(error.fields, std::vector<std::string>{"mesh_id"});
}

TEST_F(MeshTest, OptionsAreChecked) {
  v1::EnergyOptions energy;
  energy.add_rigidity(1);
  auto error = ExpectError(RegisterWith(energy), grpc::INVALID_ARGUMENT, "ARRAY_LENGTH");
  EXPECT_EQ(error.fields, std::vector<std::string>{"energy.rigidity"});
  EXPECT_EQ(error.metadata.at("expected"), "8");
  for (const double bad : {0.0, -1.0, 2e6, std::numeric_limits<double>::quiet_NaN()}) {
    energy.mutable_rigidity()->Resize(8, 1);
    energy.set_rigidity(3, bad);
    ExpectError(RegisterWith(energy), grpc::INVALID_ARGUMENT, "INVALID_OPTION");
  }
  energy.Clear();
  energy.set_basis(static_cast<v1::Basis>(77));
  error = ExpectError(RegisterWith(energy), grpc::INVALID_ARGUMENT, "INVALID_OPTION");
  EXPECT_EQ(error.fields, std::vector<std::string>{"energy.basis"});
  for (const v1::Basis basis :
       {v1::BASIS_EDGE, v1::BASIS_EDGE_AS_PUBLISHED, v1::BASIS_FACE, v1::BASIS_VERTEX}) {
    for (const v1::EdgeWeights weights : {v1::EDGE_WEIGHTS_UNIFORM, v1::EDGE_WEIGHTS_COTANGENT}) {
      energy.set_basis(basis);
      energy.set_weights(weights);
      EXPECT_TRUE(RegisterWith(energy).ok()) << basis << " " << weights;
    }
  }
}

// One way to spoil a mesh, and what the server must say of it.
struct Spoiled {
  const char* name;
  std::function<void(v1::PlanarMesh&)> spoil;
  const char* reason;
  const char* elements;  // "" when none are named
};

void PrintTo(const Spoiled& spoiled, std::ostream* out) { *out << spoiled.name; }

void AddTriangle(v1::PlanarMesh& mesh, std::uint32_t i, std::uint32_t j, std::uint32_t k) {
  for (const std::uint32_t vertex : {i, j, k}) mesh.add_triangles(vertex);
}

class SpoiledMeshTest : public MeshTest, public ::testing::WithParamInterface<Spoiled> {};

TEST_P(SpoiledMeshTest, IsNamedAndTheServerServesOn) {
  v1::PlanarMesh mesh = Grid(2, 2);
  GetParam().spoil(mesh);
  const auto error =
      ExpectError(Register("s", "m", mesh), grpc::INVALID_ARGUMENT, GetParam().reason);
  if (*GetParam().elements != '\0') {
    EXPECT_EQ(error.metadata.at("elements"), GetParam().elements);
  }
  v1::GetMeshResponse known;
  ExpectError(Get("m", &known), grpc::NOT_FOUND, "NOT_FOUND");
  EXPECT_TRUE(Register("s", "m", Grid(2, 2)).ok());
  EXPECT_TRUE(Compile("s", "m", "h", {VertexHandle("a", 0)}).ok());
  EXPECT_TRUE(Deform("s", "h", {TargetAt("a", 1, 1)}).ok());
}

INSTANTIATE_TEST_SUITE_P(
    Meshes, SpoiledMeshTest,
    ::testing::Values(
        Spoiled{"Empty", [](v1::PlanarMesh& mesh) { mesh.Clear(); }, "EMPTY_MESH", ""},
        Spoiled{"OddCoordinates", [](v1::PlanarMesh& mesh) { mesh.add_vertices(1); },
                "ARRAY_LENGTH", ""},
        Spoiled{"OddTriangles", [](v1::PlanarMesh& mesh) { mesh.add_triangles(1); }, "ARRAY_LENGTH",
                ""},
        Spoiled{"IndexOutOfRange", [](v1::PlanarMesh& mesh) { mesh.set_triangles(5, 9); },
                "INDEX_OUT_OF_RANGE", "1"},
        Spoiled{"NanCoordinate",
                [](v1::PlanarMesh& mesh) {
                  mesh.set_vertices(7, std::numeric_limits<double>::quiet_NaN());
                },
                "NON_FINITE_COORDINATE", "3"},
        Spoiled{"InfiniteCoordinate",
                [](v1::PlanarMesh& mesh) {
                  mesh.set_vertices(0, -std::numeric_limits<double>::infinity());
                },
                "NON_FINITE_COORDINATE", "0"},
        Spoiled{"RepeatedIndex",
                [](v1::PlanarMesh& mesh) { mesh.set_triangles(1, mesh.triangles(0)); },
                "REPEATED_INDEX", "0"},
        Spoiled{"DuplicateTriangle", [](v1::PlanarMesh& mesh) { AddTriangle(mesh, 0, 1, 4); },
                "DUPLICATE_TRIANGLE", ""},
        Spoiled{"NonManifoldEdge",
                [](v1::PlanarMesh& mesh) {
                  // A third triangle on the diagonal 0–4 of the first square.
                  mesh.add_vertices(3);
                  mesh.add_vertices(0.5);
                  AddTriangle(mesh, 0, 9, 4);
                },
                "NON_MANIFOLD_EDGE", ""},
        Spoiled{"DegenerateTriangle",
                [](v1::PlanarMesh& mesh) {
                  // The corner moves onto the diagonal of its only two neighbours.
                  mesh.set_vertices(2 * 2, 1.5);
                  mesh.set_vertices(2 * 2 + 1, 0.5);
                },
                "DEGENERATE_TRIANGLE", ""}),
    [](const auto& test) { return test.param.name; });

class MeshQuotaTest : public WireTest {};

TEST_F(MeshQuotaTest, MeshesOfOneSession) {
  options().limits.max_meshes_per_session = 1;
  ASSERT_TRUE(CreateSession("s").ok());
  ASSERT_TRUE(Register("s", "m", Grid(2, 2)).ok());
  const auto error =
      ExpectError(Register("s", "n", Grid(3, 2)), grpc::RESOURCE_EXHAUSTED, "LIMIT_EXCEEDED");
  EXPECT_EQ(error.metadata.at("quota"), "max_meshes_per_session");
  EXPECT_EQ(error.metadata.at("limit"), "1");
  EXPECT_TRUE(Register("s", "m", Grid(2, 2)).ok()) << "repeating needs no room";
}

TEST_F(MeshQuotaTest, VerticesAndTriangles) {
  options().limits.max_vertices = 9;
  options().limits.max_triangles = 8;
  ASSERT_TRUE(CreateSession("s").ok());
  EXPECT_TRUE(Register("s", "m", Grid(2, 2)).ok());
  auto error =
      ExpectError(Register("s", "n", Grid(3, 2)), grpc::RESOURCE_EXHAUSTED, "MESH_TOO_LARGE");
  EXPECT_EQ(error.metadata.at("limit"), "9");
  v1::PlanarMesh mesh = Grid(2, 2);
  AddTriangle(mesh, 0, 1, 8);
  error = ExpectError(Register("s", "n", mesh), grpc::RESOURCE_EXHAUSTED, "MESH_TOO_LARGE");
  EXPECT_EQ(error.metadata.at("limit"), "8");
}

TEST_F(MeshQuotaTest, BytesOfOneMessage) {
  options().limits.max_message_bytes = 4'096;
  ASSERT_TRUE(CreateSession("s").ok());
  // gRPC itself refuses this one, before there is anything to decode.
  EXPECT_EQ(Register("s", "m", Grid(40, 40)).error_code(), grpc::RESOURCE_EXHAUSTED);
  EXPECT_TRUE(Register("s", "m", Grid(2, 2)).ok());
}

}  // namespace
}  // namespace arap::wire
