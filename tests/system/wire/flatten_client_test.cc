// Flatten through the client library: every option arrives, every part of the
// answer comes back.
#include <numbers>

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

std::vector<double> Numbers(const std::vector<Complex>& points) {
  std::vector<double> flat;
  for (const Complex p : points) flat.insert(flat.end(), {p.real(), p.imag()});
  return flat;
}

template <class Number, std::size_t kCount>
std::vector<Number> Numbers(const std::vector<std::array<Number, kCount>>& groups) {
  std::vector<Number> flat;
  for (const auto& group : groups) flat.insert(flat.end(), group.begin(), group.end());
  return flat;
}

class FlattenClientTest : public FlattenTest {
 protected:
  client::Client Connect() { return client::Client::Connect(host().addresses().front()); }
};

TEST_F(FlattenClientTest, EverythingArrivesAndComesBack) {
  SurfaceMesh mesh = testing::Together(testing::SphereCap(5, 12, 1.5), BentStrip(), {5, 0, 0});
  const auto base = static_cast<std::uint32_t>(mesh.vertices.size() - 14);
  v1::FlattenRequest request = RequestFor(mesh);
  client::FlattenQuery query;
  FlattenOptions& options = query.options;
  request.set_method(v1::FLATTEN_METHOD_FIRST_STEP);
  options.method = FlattenMethod::kFirstStep;
  request.mutable_energy()->set_basis(v1::BASIS_FACE);
  options.energy.basis = Basis::kFace;
  request.set_anchors(v1::FLATTEN_ANCHORS_FAR_BOUNDARY);
  options.anchors = FlattenAnchors::kFarBoundary;
  request.set_refine(7);
  options.refine = 7;
  request.set_refine_stop(0.25);
  options.refine_stop = 0.25;
  for (const std::uint32_t v : {base + 4, base + 5}) request.add_seam_edges(v);
  options.cut.seams = {{base + 4, base + 5}};
  request.set_auto_cut(true);
  options.cut.auto_cut = true;
  request.mutable_repair()->set_stitch(true);
  request.mutable_repair()->set_tolerance(1e-4);
  options.cut.repair = {.stitch = true, .tolerance = 1e-4};
  request.set_split_non_manifold(true);
  options.cut.split_non_manifold = true;
  request.set_tolerate_degenerate(true);
  options.cut.tolerate_degenerate = true;
  for (const std::uint32_t v : {base, base + 2}) {
    v1::UvPin& pin = *request.add_pins();
    pin.set_vertex(v);
    pin.set_u(0.5 * v);
    pin.set_v(-1);
    pin.set_weight(2);
    options.pins.push_back({v, {0.5 * v, -1}, 2});
  }
  v1::GrainLine& line = *request.add_grain_lines();
  line.set_from_vertex(3);
  line.set_to_vertex(8);
  line.set_angle_degrees(33);
  options.grain_lines.push_back({3, 8, 33 * (std::numbers::pi / 180)});
  request.set_include_first_step(true);
  query.first_step = true;
  request.set_include_singular_values(true);
  query.singular_values = true;
  request.set_float64(true);
  query.float64 = true;

  const v1::FlattenResponse wire = Flat(request);
  query.surface_key = "k";
  const auto answer = Connect().Flatten(mesh, query);
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_FALSE(answer->surface_cached);
  const Flattening& flat = answer->flat;
  EXPECT_THAT(Numbers(flat.uv), ElementsAreArray(wire.uv64()));
  EXPECT_THAT(flat.source, ElementsAreArray(wire.uv_vertex()));
  EXPECT_THAT(Numbers(flat.corner_uv), ElementsAreArray(wire.corner_uv()));
  EXPECT_THAT(Numbers(flat.first_step), ElementsAreArray(wire.first_step_uv()));
  EXPECT_THAT(Numbers(flat.singular_values), ElementsAreArray(wire.singular_values()));
  EXPECT_THAT(flat.triangle_chart, ElementsAreArray(wire.triangle_chart()));
  EXPECT_THAT(flat.cuts, ElementsAre(ElementsAre(base + 4, base + 5)));
  EXPECT_EQ(flat.auto_cuts, 0u);
  EXPECT_THAT(flat.degenerate, IsEmpty());
  EXPECT_EQ(flat.overlaps, wire.boundary_overlaps());
  EXPECT_EQ(flat.distortion.worst_triangle, wire.distortion().worst_triangle());
  ASSERT_THAT(flat.charts, SizeIs(3));
  for (int i = 0; i < 3; ++i) {
    const FlatChart& chart = flat.charts[static_cast<std::size_t>(i)];
    ASSERT_THAT(chart.loops, SizeIs(wire.charts(i).loops_size()));
    EXPECT_THAT(chart.loops[0], ElementsAreArray(wire.charts(i).loops(0).uv_indices()));
    EXPECT_THAT(chart.anchors, ElementsAreArray(wire.charts(i).anchors()));
    EXPECT_EQ(chart.triangles, wire.charts(i).triangle_count());
    EXPECT_EQ(chart.refinements, static_cast<int>(wire.charts(i).refinements()));
    EXPECT_EQ(chart.distortion.arap_energy, wire.charts(i).distortion().arap_energy());
  }
  EXPECT_TRUE(Connect().Flatten(mesh, query)->surface_cached);
}

TEST_F(FlattenClientTest, FaultsHaveTheirKinds) {
  options().limits.max_flatten_triangles = 100;
  const client::Client client = Connect();
  EXPECT_EQ(client.Flatten(Bowtie()).error().kind, FaultKind::kNonManifoldVertex);
  client::FlattenQuery cut;
  cut.options.cut.seams = {{0, 13}};
  const auto seam = client.Flatten(BentStrip(), cut);
  EXPECT_EQ(seam.error().kind, FaultKind::kUnknownEdge);
  EXPECT_EQ(seam.error().field, "seam_edges[0]");
  EXPECT_THAT(seam.error().elements, ElementsAre(0, 13));
  client::FlattenQuery mirrored;
  mirrored.options.injective = true;
  mirrored.options.pins = {{0, {0, 0}}, {2, {0, 1}}, {1, {1, 0}}};
  EXPECT_EQ(client.Flatten(BentStrip(), mirrored).error().kind, FaultKind::kNotInjective);
  const auto large = client.Flatten(testing::Sphere(8, 12));
  EXPECT_EQ(large.error().kind, FaultKind::kLimitExceeded);
  EXPECT_EQ(client::DetailOf(large.error(), "limit"), "100");
  EXPECT_EQ(client::DetailOf(large.error(), client::kRetryDelayDetail), "3600000");
  EXPECT_EQ(client.GetServerInfo()->limits.max_flatten_triangles, 100u);
}

}  // namespace
}  // namespace arap::wire
