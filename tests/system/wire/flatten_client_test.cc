// Flatten through the client library: every option arrives, every part of the
// answer comes back.
#include <gmock/gmock.h>

#include "arap/client/client.h"
#include "tests/support/surfaces.h"
#include "tests/system/wire/flatten_fixture.h"

namespace arap::wire {
namespace {

using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class FlattenClientTest : public FlattenTest {
 protected:
  client::Client Connect() { return client::Client::Connect(host().addresses().front()); }
  static client::SurfaceMesh Given(const SurfaceMesh& mesh) {
    const v1::FlattenRequest request = RequestFor(mesh);
    return {{request.mesh().vertices().begin(), request.mesh().vertices().end()},
            {request.mesh().triangles().begin(), request.mesh().triangles().end()}};
  }
};

TEST_F(FlattenClientTest, EverythingArrivesAndComesBack) {
  SurfaceMesh mesh = testing::Together(testing::SphereCap(5, 12, 1.5), BentStrip(), {5, 0, 0});
  const auto base = static_cast<std::uint32_t>(mesh.vertices.size() - 14);
  v1::FlattenRequest request = RequestFor(mesh);
  client::FlattenOptions options;
  request.set_method(v1::FLATTEN_METHOD_FIRST_STEP);
  options.method = client::FlattenMethod::kFirstStep;
  request.mutable_energy()->set_basis(v1::BASIS_FACE);
  options.energy.basis = client::Basis::kFace;
  request.set_anchors(v1::FLATTEN_ANCHORS_FAR_BOUNDARY);
  options.anchors = client::FlattenAnchors::kFarBoundary;
  request.set_refine(7);
  options.refine = 7;
  request.set_refine_stop(0.25);
  options.refine_stop = 0.25;
  for (const std::uint32_t v : {base + 4, base + 5}) {
    request.add_seam_edges(v);
    options.seam_edges.push_back(v);
  }
  request.set_auto_cut(true);
  options.auto_cut = true;
  request.set_split_non_manifold(true);
  options.split_non_manifold = true;
  request.set_tolerate_degenerate(true);
  options.tolerate_degenerate = true;
  for (const std::uint32_t v : {base, base + 2}) {
    v1::UvPin& pin = *request.add_pins();
    pin.set_vertex(v);
    pin.set_u(0.5 * v);
    pin.set_v(-1);
    pin.set_weight(2);
    options.pins.push_back({v, 0.5 * v, -1, 2});
  }
  v1::GrainLine& line = *request.add_grain_lines();
  line.set_from_vertex(3);
  line.set_to_vertex(8);
  line.set_angle_degrees(33);
  options.grain_lines.push_back({3, 8, 33});
  request.set_include_first_step(true);
  options.first_step = true;
  request.set_include_singular_values(true);
  options.singular_values = true;
  request.set_float64(true);
  options.float64 = true;

  const v1::FlattenResponse wire = Flat(request);
  options.surface_key = "k";
  const auto flat = Connect().Flatten(Given(mesh), options);
  ASSERT_TRUE(flat) << flat.error().message;
  EXPECT_FALSE(flat->surface_cached);
  EXPECT_THAT(flat->uv, ElementsAreArray(wire.uv64()));
  EXPECT_THAT(flat->uv_vertex, ElementsAreArray(wire.uv_vertex()));
  EXPECT_THAT(flat->corner_uv, ElementsAreArray(wire.corner_uv()));
  EXPECT_THAT(flat->first_step_uv, ElementsAreArray(wire.first_step_uv()));
  EXPECT_THAT(flat->singular_values, ElementsAreArray(wire.singular_values()));
  EXPECT_THAT(flat->triangle_chart, ElementsAreArray(wire.triangle_chart()));
  EXPECT_THAT(flat->cut_edges, ElementsAre(base + 4, base + 5));
  EXPECT_EQ(flat->auto_cut_count, 0u);
  EXPECT_THAT(flat->left_out_triangles, IsEmpty());
  EXPECT_EQ(flat->boundary_overlaps, wire.boundary_overlaps());
  EXPECT_EQ(flat->distortion.worst_triangle, wire.distortion().worst_triangle());
  ASSERT_THAT(flat->charts, SizeIs(3));
  for (int i = 0; i < 3; ++i) {
    const client::FlatChart& chart = flat->charts[static_cast<std::size_t>(i)];
    ASSERT_THAT(chart.loops, SizeIs(wire.charts(i).loops_size()));
    EXPECT_THAT(chart.loops[0], ElementsAreArray(wire.charts(i).loops(0).uv_indices()));
    EXPECT_THAT(chart.anchors, ElementsAreArray(wire.charts(i).anchors()));
    EXPECT_EQ(chart.triangle_count, wire.charts(i).triangle_count());
    EXPECT_EQ(chart.refinements, wire.charts(i).refinements());
    EXPECT_EQ(chart.distortion.arap_energy, wire.charts(i).distortion().arap_energy());
  }
  EXPECT_TRUE(Connect().Flatten(Given(mesh), options)->surface_cached);
}

TEST_F(FlattenClientTest, FaultsHaveTheirKinds) {
  options().limits.max_flatten_triangles = 100;
  const client::Client client = Connect();
  EXPECT_EQ(client.Flatten(Given(Bowtie())).error().kind, FaultKind::kNonManifoldVertex);
  client::FlattenOptions cut;
  cut.seam_edges = {0, 13};
  const auto seam = client.Flatten(Given(BentStrip()), cut);
  EXPECT_EQ(seam.error().kind, FaultKind::kUnknownEdge);
  EXPECT_EQ(seam.error().field, "seam_edges[0]");
  EXPECT_THAT(seam.error().elements, ElementsAre(0, 13));
  client::FlattenOptions mirrored;
  mirrored.injective = true;
  mirrored.pins = {{0, 0, 0, 0}, {2, 0, 1, 0}, {1, 1, 0, 0}};
  EXPECT_EQ(client.Flatten(Given(BentStrip()), mirrored).error().kind, FaultKind::kNotInjective);
  const auto large = client.Flatten(Given(testing::Sphere(8, 12)));
  EXPECT_EQ(large.error().kind, FaultKind::kLimitExceeded);
  EXPECT_EQ(client::Detail(large.error(), "limit"), "100");
  EXPECT_EQ(client::Detail(large.error(), client::kRetryDelayDetail), "3600000");
  EXPECT_EQ(client.GetServerInfo()->limits.max_flatten_triangles, 100u);
}

}  // namespace
}  // namespace arap::wire
