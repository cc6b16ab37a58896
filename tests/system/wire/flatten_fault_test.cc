// Flatten over the wire: every refusal is named, and the server goes on serving.
#include <limits>

#include <gmock/gmock.h>

#include "core/mesh/space.h"
#include "tests/support/bounded.h"
#include "tests/support/surfaces.h"
#include "tests/system/wire/flatten_fixture.h"

namespace arap::wire {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

class FlattenFaultTest : public FlattenTest {
 protected:
  // An option that is refused, with its field.
  WireError BadOption(const v1::FlattenRequest& request, const char* field) {
    const WireError error = Refusal(request, grpc::INVALID_ARGUMENT, "INVALID_OPTION");
    EXPECT_THAT(error.fields, ElementsAre(field)) << error.message;
    return error;
  }
  // A surface that is refused, with its elements.
  void BadSurface(const SurfaceMesh& mesh, const char* reason, const char* elements) {
    const WireError error = Refusal(RequestFor(mesh), grpc::INVALID_ARGUMENT, reason);
    const auto found = error.metadata.find("elements");
    EXPECT_EQ(found == error.metadata.end() ? "" : found->second, elements) << error.message;
  }
};

TEST_F(FlattenFaultTest, Arrays) {
  Refusal({}, grpc::INVALID_ARGUMENT, "EMPTY_MESH");
  v1::FlattenRequest request = RequestFor(BentStrip());
  request.mutable_mesh()->set_triangles(0, 99);
  EXPECT_EQ(Refusal(request, grpc::INVALID_ARGUMENT, "INDEX_OUT_OF_RANGE").metadata.at("elements"),
            "0");
  request = RequestFor(BentStrip());
  request.mutable_mesh()->set_triangles(4, 1);
  EXPECT_EQ(Refusal(request, grpc::INVALID_ARGUMENT, "REPEATED_INDEX").metadata.at("elements"),
            "1");
  request = RequestFor(BentStrip());
  request.mutable_mesh()->add_vertices(1);
  EXPECT_THAT(Refusal(request, grpc::INVALID_ARGUMENT, "ARRAY_LENGTH").fields,
              ElementsAre("mesh.vertices"));
  request = RequestFor(BentStrip());
  request.mutable_mesh()->add_triangles(1);
  EXPECT_THAT(Refusal(request, grpc::INVALID_ARGUMENT, "ARRAY_LENGTH").fields,
              ElementsAre("mesh.triangles"));
  request = RequestFor(BentStrip());
  request.add_seam_edges(2);
  EXPECT_THAT(Refusal(request, grpc::INVALID_ARGUMENT, "ARRAY_LENGTH").fields,
              ElementsAre("seam_edges"));
  request = RequestFor(BentStrip());
  request.mutable_energy()->add_rigidity(1);
  EXPECT_THAT(Refusal(request, grpc::INVALID_ARGUMENT, "ARRAY_LENGTH").fields,
              ElementsAre("energy.rigidity"));
  for (const double value : {kNan, kInfinity, -kInfinity}) {
    request = RequestFor(BentStrip());
    request.mutable_mesh()->set_vertices(10, value);
    EXPECT_EQ(
        Refusal(request, grpc::INVALID_ARGUMENT, "NON_FINITE_COORDINATE").metadata.at("elements"),
        "3");
  }
}

TEST_F(FlattenFaultTest, Surfaces) {
  BadSurface(Fan(), "NON_MANIFOLD_EDGE", "0,1,2");
  BadSurface(Bowtie(), "NON_MANIFOLD_VERTEX", "0");
  const v1::FlattenRequest moebius = RequestFor(testing::MoebiusBand(8));
  ExpectNeighbours(
      moebius, Refusal(moebius, grpc::INVALID_ARGUMENT, "NOT_ORIENTABLE").metadata.at("elements"));
  BadSurface(testing::Sphere(4, 6), "NOT_A_DISK", "0");
  BadSurface(testing::Together(BentStrip(), testing::Torus(6, 5, 3, 1), {9, 0, 0}), "NOT_A_DISK",
             "12");
  SurfaceMesh mesh = BentStrip();
  mesh.triangles.push_back({mesh.triangles[3][1], mesh.triangles[3][2], mesh.triangles[3][0]});
  BadSurface(mesh, "DUPLICATE_TRIANGLE", "3,12");
  mesh = BentStrip();
  mesh.vertices[2] = ToPoint3(0.5 * (Vec(mesh.vertices[0]) + Vec(mesh.vertices[1])));
  BadSurface(mesh, "DEGENERATE_TRIANGLE", "0");
}

TEST_F(FlattenFaultTest, Options) {
  v1::FlattenRequest request = RequestFor(BentStrip());
  request.set_method(static_cast<v1::FlattenMethod>(77));
  EXPECT_EQ(BadOption(request, "method").metadata.at("value"), "77");
  request = RequestFor(BentStrip());
  request.set_anchors(static_cast<v1::FlattenAnchors>(77));
  BadOption(request, "anchors");
  request = RequestFor(BentStrip());
  request.mutable_energy()->set_basis(static_cast<v1::Basis>(77));
  BadOption(request, "energy.basis");
  request = RequestFor(BentStrip());
  request.mutable_energy()->set_weights(static_cast<v1::EdgeWeights>(77));
  BadOption(request, "energy.weights");
  request = RequestFor(BentStrip());
  request.set_refine(1001);
  const WireError refine = BadOption(request, "refine");
  EXPECT_EQ(refine.metadata.at("quota"), "max_refine");
  EXPECT_EQ(refine.metadata.at("limit"), "1000");
  for (const double stop : {-1e-9, 1.5, kNan, kInfinity}) {
    request = RequestFor(BentStrip());
    request.set_refine_stop(stop);
    BadOption(request, "refine_stop");
  }
  request = RequestFor(BentStrip());
  for (int t = 0; t < 12; ++t) request.mutable_energy()->add_rigidity(t == 7 ? -1 : 1);
  const WireError rigidity = Refusal(request, grpc::INVALID_ARGUMENT, "INVALID_OPTION");
  EXPECT_EQ(rigidity.metadata.at("elements"), "7");
  request = RequestFor(BentStrip());
  request.set_surface_key("no spaces");
  EXPECT_THAT(Refusal(request, grpc::INVALID_ARGUMENT, "INVALID_NAME").fields,
              ElementsAre("surface_key"));
}

TEST_F(FlattenFaultTest, MethodAndBasisMustNotContradict) {
  const auto refused = [&](v1::FlattenMethod method, v1::Basis basis) {
    v1::FlattenRequest request = RequestFor(BentStrip());
    request.set_method(method);
    request.mutable_energy()->set_basis(basis);
    BadOption(request, "energy.basis");
  };
  for (int method = 0; method < v1::FlattenMethod_ARRAYSIZE; ++method) {
    refused(static_cast<v1::FlattenMethod>(method), v1::BASIS_VERTEX);
  }
  refused(v1::FLATTEN_METHOD_ARAP_EDGE, v1::BASIS_FACE);
  for (const v1::Basis basis : {v1::BASIS_EDGE, v1::BASIS_EDGE_AS_PUBLISHED}) {
    refused(v1::FLATTEN_METHOD_ARAP_FACE, basis);
    refused(v1::FLATTEN_METHOD_LSCM, basis);
    refused(v1::FLATTEN_METHOD_ABF, basis);
  }
  for (const v1::FlattenMethod method : {v1::FLATTEN_METHOD_LSCM, v1::FLATTEN_METHOD_ABF}) {
    v1::FlattenRequest request = RequestFor(BentStrip());
    request.set_method(method);
    request.mutable_energy()->set_weights(v1::EDGE_WEIGHTS_UNIFORM);
    BadOption(request, "energy.weights");
  }
}

TEST_F(FlattenFaultTest, Seams) {
  v1::FlattenRequest request = RequestFor(BentStrip());
  for (const std::uint32_t v : {2u, 3u, 0u, 13u}) request.add_seam_edges(v);
  const WireError error = Refusal(request, grpc::INVALID_ARGUMENT, "UNKNOWN_EDGE");
  EXPECT_EQ(error.metadata.at("elements"), "0,13");
  EXPECT_THAT(error.fields, ElementsAre("seam_edges[2]"));
}

v1::FlattenRequest Pinned(std::uint32_t vertex, double u, double v, double weight) {
  v1::FlattenRequest request = RequestFor(BentStrip());
  request.add_pins();  // vertex 0 at the origin
  v1::UvPin& pin = *request.add_pins();
  pin.set_vertex(vertex);
  pin.set_u(u);
  pin.set_v(v);
  pin.set_weight(weight);
  return request;
}

TEST_F(FlattenFaultTest, Pins) {
  BadOption(Pinned(1, kNan, 0, 0), "pins[1].u");
  BadOption(Pinned(1, 0, kInfinity, 0), "pins[1].v");
  for (const double weight : {-1.0, 2e9, kNan, kInfinity}) {
    BadOption(Pinned(1, 2, 0, weight), "pins[1].weight");
  }
  v1::FlattenResponse response;
  const WireError unknown = Decode(Flatten(Pinned(14, 2, 0, 0), &response));
  EXPECT_EQ(unknown.code, grpc::INVALID_ARGUMENT);
  EXPECT_THAT(unknown.fields, ElementsAre("pins[1].vertex"));
  EXPECT_EQ(BadOption(Pinned(0, 2, 0, 0), "pins[1].vertex").metadata.at("elements"), "0")
      << "pinned twice";
}

TEST_F(FlattenFaultTest, GrainLines) {
  const auto with = [](std::uint32_t from, std::uint32_t to, double angle) {
    v1::FlattenRequest request = RequestFor(BentStrip());
    v1::GrainLine& line = *request.add_grain_lines();
    line.set_from_vertex(from);
    line.set_to_vertex(to);
    line.set_angle_degrees(angle);
    return request;
  };
  BadOption(with(0, 4, kNan), "grain_lines[0].angle_degrees");
  v1::FlattenResponse response;
  EXPECT_THAT(Decode(Flatten(with(14, 4, 0), &response)).fields,
              ElementsAre("grain_lines[0].from_vertex"));
  EXPECT_THAT(Decode(Flatten(with(0, 14, 0), &response)).fields,
              ElementsAre("grain_lines[0].to_vertex"));
  BadOption(with(3, 3, 0), "grain_lines[0]");
  v1::FlattenRequest pinned = Pinned(12, 6, 0, 0);
  pinned.add_grain_lines()->set_to_vertex(4);
  BadOption(pinned, "grain_lines[0]");
  v1::FlattenRequest twice = with(0, 4, 0);
  twice.add_grain_lines()->set_to_vertex(6);
  BadOption(twice, "grain_lines[1]");
}

TEST_F(FlattenFaultTest, InjectiveOrNothing) {
  // A triangle held mirrored has no upright layout.
  v1::FlattenRequest request = RequestFor(testing::SphereCap(3, 8, 1.0));
  for (int k = 0; k < 3; ++k) {
    v1::UvPin& pin = *request.add_pins();
    pin.set_vertex(request.mesh().triangles(k));
    pin.set_u(k == 2 ? 1 : 0);
    pin.set_v(k == 1 ? 1 : 0);
  }
  v1::FlattenResponse response;
  ASSERT_TRUE(Flatten(request, &response).ok());
  EXPECT_GT(response.distortion().flipped(), 0u);
  request.set_injective(true);
  const WireError error = Refusal(request, grpc::FAILED_PRECONDITION, "NOT_INJECTIVE");
  EXPECT_EQ(error.metadata.at("elements"), "0");
}

TEST_F(FlattenFaultTest, TooManyTrianglesAreRefusedBeforeAnythingElse) {
  options().limits.max_flatten_triangles = 12;
  EXPECT_EQ(Flat(RequestFor(BentStrip())).corner_uv_size(), 36) << "12 are not too many";
  v1::FlattenRequest request = RequestFor(testing::SphereCap(2, 6, 1.0));
  ASSERT_GT(request.mesh().triangles_size() / 3, 12);
  // Everything else is wrong too.
  request.mutable_mesh()->set_vertices(0, kNan);
  request.mutable_mesh()->add_vertices(0);
  request.set_refine(5000);
  const WireError error = Refusal(request, grpc::RESOURCE_EXHAUSTED, "LIMIT_EXCEEDED");
  EXPECT_EQ(error.metadata.at("quota"), "max_flatten_triangles");
  EXPECT_EQ(error.metadata.at("limit"), "12");
  EXPECT_THAT(error.fields, ElementsAre("mesh.triangles"));
  EXPECT_EQ(error.retry_seconds, 3'600) << "it will be as large a second later";
}

TEST_F(FlattenFaultTest, MeshLimitsHoldToo) {
  options().limits.max_vertices = 14;
  EXPECT_TRUE(Flat(RequestFor(BentStrip())).uv_size() > 0);
  const WireError error = Refusal(RequestFor(testing::SphereCap(2, 9, 1.0)),
                                  grpc::RESOURCE_EXHAUSTED, "MESH_TOO_LARGE");
  EXPECT_EQ(error.metadata.at("quota"), "max_vertices");
}

TEST_F(FlattenFaultTest, DeadlineOfAWaitingCall) {
  options().lanes = {1, 1};
  options().limits.max_queued_jobs = 4;
  PoolGate gate(host().engine().jobs);
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::milliseconds(1));
  v1::FlattenResponse response;
  EXPECT_EQ(flattening().Flatten(&context, RequestFor(BentStrip()), &response).error_code(),
            grpc::DEADLINE_EXCEEDED);
  gate.Open();
  Flat(RequestFor(BentStrip()));
}

TEST_F(FlattenFaultTest, CancelledCallsLeaveTheLane) {
  options().lanes = {1, 1};
  options().limits.max_queued_jobs = 4;
  // Long enough that nobody would wait for its end.
  v1::FlattenRequest request = RequestFor(testing::SphereCap(120, 200, 1.8));
  request.set_refine(1000);
  request.set_refine_stop(0);
  for (const bool waiting : {true, false}) {
    PoolGate gate(host().engine().jobs);
    grpc::ClientContext context;
    SetDeadline(context);
    v1::FlattenResponse response;
    grpc::Status status;
    testing::BoundedThread call("the call that is cancelled", [&] {
      status = flattening().Flatten(&context, request, &response);
    });
    ASSERT_TRUE(
        testing::Await("the job waits", [&] { return host().engine().jobs.waiting() > 0; }));
    if (!waiting) {
      gate.Open();
      ASSERT_TRUE(
          testing::Await("the job runs", [&] { return host().engine().jobs.waiting() == 0; }));
    }
    context.TryCancel();
    call.Join();
    EXPECT_EQ(status.error_code(), grpc::CANCELLED);
    gate.Open();
    Flat(RequestFor(BentStrip()));
  }
}

}  // namespace
}  // namespace arap::wire
