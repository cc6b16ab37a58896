// Flatten over the wire.
#include <cmath>

#include "tests/wire/wire_fixture.h"

namespace arap::wire {
namespace {

class FlattenTest : public WireTest {
 protected:
  grpc::Status Flatten(const v1::FlattenRequest& request, v1::FlattenResponse* response) {
    grpc::ClientContext context;
    SetDeadline(context);
    return flattening().Flatten(&context, request, response);
  }

  // A strip of flat facets bent about an axis: it unrolls without distortion.
  static v1::FlattenRequest BentStrip() {
    constexpr int kFacets = 6;
    constexpr double kBend = 0.3;
    v1::FlattenRequest request;
    v1::SurfaceMesh& mesh = *request.mutable_mesh();
    double x = 0;
    double z = 0;
    for (int i = 0; i <= kFacets; ++i) {
      for (const double y : {0.0, 2.0}) {
        for (const double value : {x, y, z}) mesh.add_vertices(value);
      }
      x += std::cos(kBend * i);
      z += std::sin(kBend * i);
    }
    for (std::uint32_t i = 0; i < kFacets; ++i) {
      const std::uint32_t v = 2 * i;
      for (const std::uint32_t vertex : {v, v + 2, v + 1, v + 1, v + 2, v + 3}) {
        mesh.add_triangles(vertex);
      }
    }
    return request;
  }
};

TEST_F(FlattenTest, DevelopableSurfaceUnrollsTrueToSize) {
  v1::FlattenRequest request = BentStrip();
  request.set_include_first_step(true);
  request.set_include_singular_values(true);
  v1::FlattenResponse response;
  const grpc::Status status = Flatten(request, &response);
  ASSERT_TRUE(status.ok()) << status.error_message();
  ASSERT_EQ(response.uv_size(), 28);
  EXPECT_EQ(response.uv64_size(), 0);
  EXPECT_EQ(response.uv_vertex_size(), 14);
  EXPECT_EQ(response.first_step_uv_size(), 28);
  EXPECT_EQ(response.singular_values_size(), 24);
  EXPECT_EQ(response.anchor_vertices_size(), 2);
  EXPECT_EQ(response.corner_uv_size(), request.mesh().triangles_size());
  EXPECT_TRUE(std::equal(response.corner_uv().begin(), response.corner_uv().end(),
                         request.mesh().triangles().begin()));
  for (const float s : response.singular_values()) EXPECT_NEAR(s, 1, 1e-5);
  EXPECT_NEAR(response.distortion().arap_energy(), 0, 1e-10);
  EXPECT_NEAR(response.distortion().symmetric_dirichlet(), 4, 1e-8);
  EXPECT_NEAR(response.distortion().area_ratio(), 1, 1e-8);
  EXPECT_EQ(response.distortion().flipped(), 0u);
  EXPECT_EQ(response.distortion().scale(), 1);
  const double length =
      std::hypot(response.uv(24) - response.uv(0), response.uv(25) - response.uv(1));
  EXPECT_NEAR(length, 6, 1e-4);
  EXPECT_GT(response.solve_time().nanos(), 0);
}

TEST_F(FlattenTest, DoublePrecisionOnRequest) {
  v1::FlattenRequest request = BentStrip();
  request.set_float64(true);
  request.set_refine(2);
  v1::FlattenResponse response;
  ASSERT_TRUE(Flatten(request, &response).ok());
  EXPECT_EQ(response.uv_size(), 0);
  EXPECT_EQ(response.uv64_size(), 28);
  EXPECT_EQ(response.first_step_uv_size(), 0);
  EXPECT_EQ(response.singular_values_size(), 0);
}

TEST_F(FlattenTest, FaultsAreNamedAndTheServerServesOn) {
  v1::FlattenResponse response;
  v1::FlattenRequest request = BentStrip();
  request.mutable_mesh()->set_triangles(0, 99);
  ExpectError(Flatten(request, &response), grpc::INVALID_ARGUMENT, "INDEX_OUT_OF_RANGE");
  request = BentStrip();
  request.mutable_mesh()->add_vertices(1);
  ExpectError(Flatten(request, &response), grpc::INVALID_ARGUMENT, "ARRAY_LENGTH");
  request = BentStrip();
  request.mutable_energy()->set_basis(v1::BASIS_VERTEX);
  ExpectError(Flatten(request, &response), grpc::INVALID_ARGUMENT, "INVALID_OPTION");
  request = BentStrip();
  request.set_refine(1001);
  const auto refine =
      ExpectError(Flatten(request, &response), grpc::INVALID_ARGUMENT, "INVALID_OPTION");
  EXPECT_EQ(refine.metadata.at("quota"), "max_refine");
  ExpectError(Flatten({}, &response), grpc::INVALID_ARGUMENT, "EMPTY_MESH");

  v1::FlattenRequest tetrahedron;
  for (const double value : {0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 1.}) {
    tetrahedron.mutable_mesh()->add_vertices(value);
  }
  for (const std::uint32_t vertex : {0u, 2u, 1u, 0u, 1u, 3u, 1u, 2u, 3u, 0u, 3u, 2u}) {
    tetrahedron.mutable_mesh()->add_triangles(vertex);
  }
  ExpectError(Flatten(tetrahedron, &response), grpc::INVALID_ARGUMENT, "NOT_A_DISK");
  EXPECT_TRUE(Flatten(BentStrip(), &response).ok());
}

TEST_F(FlattenTest, SeamsAreNotServedYet) {
  v1::FlattenRequest request = BentStrip();
  request.add_seam_edges(0);
  request.add_seam_edges(2);
  v1::FlattenResponse response;
  ExpectError(Flatten(request, &response), grpc::UNIMPLEMENTED, "UNIMPLEMENTED");
}

}  // namespace
}  // namespace arap::wire
