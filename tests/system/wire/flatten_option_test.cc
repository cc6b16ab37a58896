// Flatten over the wire: every option does what the interface says.
#include <cmath>
#include <complex>

#include <gmock/gmock.h>

#include "core/mesh/space.h"
#include "tests/support/compare.h"
#include "tests/support/surfaces.h"
#include "tests/system/wire/flatten_fixture.h"

namespace arap::wire {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// Far from developable, so that methods differ.
SurfaceMesh Cap() { return testing::SphereCap(8, 20, 1.8); }

class FlattenOptionTest : public FlattenTest {
 protected:
  std::vector<Complex> UvOf(v1::FlattenRequest request) {
    request.set_float64(true);
    return Positions(Flat(request));
  }
};

v1::FlattenRequest With(v1::FlattenMethod method, v1::Basis basis, v1::EdgeWeights weights) {
  v1::FlattenRequest request = RequestFor(Cap());
  request.set_method(method);
  request.mutable_energy()->set_basis(basis);
  request.mutable_energy()->set_weights(weights);
  return request;
}

TEST_F(FlattenOptionTest, DefaultsAreFaceCellsRefinedUntilTheyHaveConverged) {
  const auto plain = UvOf(RequestFor(Cap()));
  v1::FlattenRequest spelled =
      With(v1::FLATTEN_METHOD_ARAP_FACE, v1::BASIS_FACE, v1::EDGE_WEIGHTS_COTANGENT);
  spelled.set_anchors(v1::FLATTEN_ANCHORS_CENTER_EDGE);
  spelled.set_refine(1000);
  spelled.set_refine_stop(3e-5);
  EXPECT_EQ(plain, UvOf(spelled));
  spelled.set_refine(0);
  EXPECT_NE(plain, UvOf(spelled)) << "0 is not the default";
}

TEST_F(FlattenOptionTest, MethodAndBasisSayTheSame) {
  const auto same = [&](v1::FlattenRequest a, v1::FlattenRequest b) { return UvOf(a) == UvOf(b); };
  const auto kNone = v1::BASIS_UNSPECIFIED;
  const auto kAny = v1::EDGE_WEIGHTS_UNSPECIFIED;
  EXPECT_TRUE(same(With(v1::FLATTEN_METHOD_ARAP_EDGE, kNone, kAny),
                   With(v1::FLATTEN_METHOD_UNSPECIFIED, v1::BASIS_EDGE, kAny)));
  EXPECT_TRUE(same(With(v1::FLATTEN_METHOD_ARAP_EDGE, v1::BASIS_EDGE_AS_PUBLISHED, kAny),
                   With(v1::FLATTEN_METHOD_UNSPECIFIED, v1::BASIS_EDGE_AS_PUBLISHED, kAny)));
  EXPECT_TRUE(same(With(v1::FLATTEN_METHOD_FIRST_STEP, kNone, kAny),
                   With(v1::FLATTEN_METHOD_FIRST_STEP, v1::BASIS_EDGE, kAny)));
  v1::FlattenRequest conformal =
      With(v1::FLATTEN_METHOD_FIRST_STEP, v1::BASIS_FACE, v1::EDGE_WEIGHTS_COTANGENT);
  EXPECT_FALSE(same(With(v1::FLATTEN_METHOD_LSCM, kNone, kAny), conformal)) << "other anchors";
  conformal.set_anchors(v1::FLATTEN_ANCHORS_SPECTRAL);
  EXPECT_TRUE(same(With(v1::FLATTEN_METHOD_LSCM, kNone, kAny), conformal));
  EXPECT_FALSE(same(With(v1::FLATTEN_METHOD_LSCM, kNone, kAny),
                    With(v1::FLATTEN_METHOD_FIRST_STEP, v1::BASIS_EDGE, kAny)));
  EXPECT_FALSE(
      same(With(v1::FLATTEN_METHOD_LSCM, kNone, kAny), With(v1::FLATTEN_METHOD_ABF, kNone, kAny)));
  EXPECT_FALSE(same(With(v1::FLATTEN_METHOD_ARAP_EDGE, kNone, v1::EDGE_WEIGHTS_UNIFORM),
                    With(v1::FLATTEN_METHOD_ARAP_EDGE, kNone, v1::EDGE_WEIGHTS_COTANGENT)));
}

TEST_F(FlattenOptionTest, OnlyArapMethodsRefineByThemselves) {
  for (const auto method :
       {v1::FLATTEN_METHOD_LSCM, v1::FLATTEN_METHOD_FIRST_STEP, v1::FLATTEN_METHOD_ABF}) {
    v1::FlattenRequest request = With(method, v1::BASIS_UNSPECIFIED, v1::EDGE_WEIGHTS_UNSPECIFIED);
    const v1::FlattenResponse plain = Flat(request);
    EXPECT_EQ(plain.charts(0).refinements(), 0u) << method;
    request.set_refine(3);
    request.set_refine_stop(0);
    const v1::FlattenResponse refined = Flat(request);
    EXPECT_EQ(refined.charts(0).refinements(), 3u) << method;
    EXPECT_LT(refined.distortion().arap_energy(), plain.distortion().arap_energy()) << method;
  }
}

TEST_F(FlattenOptionTest, RefinementStopsWhereItIsTold) {
  v1::FlattenRequest request = RequestFor(Cap());
  request.set_refine(200);
  request.set_refine_stop(0.5);
  const v1::FlattenResponse early = Flat(request);
  request.set_refine_stop(1e-4);
  const v1::FlattenResponse late = Flat(request);
  EXPECT_LT(early.charts(0).refinements(), late.charts(0).refinements());
  EXPECT_LT(late.charts(0).refinements(), 200u);
  EXPECT_EQ(late.charts(0).refine_end(), v1::REFINE_END_CONVERGED);
  request.set_refine(1);
  EXPECT_EQ(Flat(request).charts(0).refine_end(), v1::REFINE_END_LIMIT);
  request.set_refine(0);
  EXPECT_EQ(Flat(request).charts(0).refine_end(), v1::REFINE_END_UNSPECIFIED);
  EXPECT_LT(late.distortion().arap_energy(), early.distortion().arap_energy());
}

TEST_F(FlattenOptionTest, AnchorsAreNamed) {
  v1::FlattenRequest request = RequestFor(Cap());
  request.set_method(v1::FLATTEN_METHOD_LSCM);
  EXPECT_THAT(Flat(request).anchor_vertices(), IsEmpty()) << "spectral by default";
  request.set_method(v1::FLATTEN_METHOD_ARAP_EDGE);
  request.set_refine(0);
  const auto plain = UvOf(request);
  request.set_anchors(v1::FLATTEN_ANCHORS_CENTER_EDGE);
  EXPECT_EQ(plain, UvOf(request)) << "the centre edge by default";
  for (const auto anchors : {v1::FLATTEN_ANCHORS_CENTER_EDGE, v1::FLATTEN_ANCHORS_FAR_BOUNDARY}) {
    request.set_anchors(anchors);
    request.set_include_first_step(true);
    const v1::FlattenResponse response = Flat(request);
    ASSERT_EQ(response.anchor_vertices_size(), 2);
    EXPECT_TRUE(std::equal(response.anchor_vertices().begin(), response.anchor_vertices().end(),
                           response.charts(0).anchors().begin()));
    // The first step leaves them at their distance in space.
    const std::uint32_t a = response.anchor_vertices(0);
    const std::uint32_t b = response.anchor_vertices(1);
    const auto first = [&](std::uint32_t v) {
      return Complex(response.first_step_uv(static_cast<int>(2 * v)),
                     response.first_step_uv(static_cast<int>(2 * v + 1)));
    };
    const SurfaceMesh cap = Cap();
    EXPECT_NEAR(std::abs(first(a) - first(b)), (Vec(cap.vertices[a]) - Vec(cap.vertices[b])).norm(),
                1e-9);
  }
}

TEST_F(FlattenOptionTest, SeamsDoubleTheirVertices) {
  v1::FlattenRequest request = RequestFor(BentStrip());
  for (const std::uint32_t v : {5u, 4u}) request.add_seam_edges(v);  // ruling 2, across the strip
  const v1::FlattenResponse response = Flat(request);
  ASSERT_EQ(response.charts_size(), 2) << "cut right through";
  EXPECT_THAT(response.cut_edges(), ElementsAre(4, 5));
  EXPECT_EQ(response.auto_cut_count(), 0u);
  ASSERT_EQ(response.uv_vertex_size(), 16);
  EXPECT_EQ(response.uv_vertex(14) + response.uv_vertex(15), 9u);
  EXPECT_EQ(response.charts(0).triangle_count(), 4u);
  EXPECT_NEAR(response.distortion().arap_energy(), 0, 1e-10);
}

TEST_F(FlattenOptionTest, ClosedSurfacesAreCutOnRequest) {
  for (const SurfaceMesh& mesh :
       {testing::Sphere(8, 12), testing::Torus(12, 8, 3, 1), testing::PlateWithHoles(2, 1)}) {
    v1::FlattenRequest request = RequestFor(mesh);
    request.set_auto_cut(true);
    const v1::FlattenResponse response = Flat(request);
    ASSERT_EQ(response.charts_size(), 1);
    EXPECT_EQ(response.charts(0).loops_size(), 1) << "a disk";
    EXPECT_GT(response.auto_cut_count(), 0u);
    EXPECT_EQ(2 * response.auto_cut_count(), static_cast<std::uint32_t>(response.cut_edges_size()));
    EXPECT_GT(response.uv_vertex_size(), static_cast<int>(mesh.vertices.size()));
  }
}

TEST_F(FlattenOptionTest, NonManifoldPlacesAreSplitOnRequest) {
  v1::FlattenRequest request = RequestFor(Fan());
  request.set_split_non_manifold(true);
  const v1::FlattenResponse fan = Flat(request);
  EXPECT_EQ(fan.charts_size(), 3);
  EXPECT_THAT(Kinds(fan), ElementsAre("split_edges"));
  request = RequestFor(Bowtie());
  request.set_split_non_manifold(true);
  const v1::FlattenResponse bowtie = Flat(request);
  EXPECT_EQ(bowtie.charts_size(), 2);
  EXPECT_EQ(bowtie.uv_vertex_size(), 6);
  EXPECT_EQ(bowtie.uv_vertex(5), 0u);
}

TEST_F(FlattenOptionTest, TrianglesWithoutAreaAreLeftOutOnRequest) {
  // A square whose right side has a point on it that belongs to a triangle without area.
  v1::FlattenRequest request =
      RequestFor({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0.5, 0}},
                  {{0, 1, 2}, {0, 2, 3}, {1, 4, 2}}});
  EXPECT_EQ(Refusal(request, grpc::INVALID_ARGUMENT, "DEGENERATE_TRIANGLE").metadata.at("elements"),
            "2");
  request.set_tolerate_degenerate(true);
  request.set_include_singular_values(true);
  const v1::FlattenResponse response = Flat(request);
  EXPECT_THAT(response.left_out_triangles(), ElementsAre(2));
  EXPECT_EQ(response.singular_values(4), 0);
  EXPECT_EQ(response.singular_values(5), 0);
  EXPECT_NEAR(response.distortion().arap_energy(), 0, 1e-10);
}

TEST_F(FlattenOptionTest, InjectiveHasNoFlips) {
  v1::FlattenRequest request = RequestFor(testing::SphereCap(12, 16, 3.0));
  request.set_method(v1::FLATTEN_METHOD_ARAP_EDGE);
  EXPECT_GT(Flat(request).distortion().flipped(), 0u) << "else it proves nothing";
  request.set_injective(true);
  EXPECT_EQ(Flat(request).distortion().flipped(), 0u);
}

TEST_F(FlattenOptionTest, PinsHold) {
  v1::FlattenRequest request = RequestFor(Cap());
  request.set_float64(true);
  const auto pin = [&](std::uint32_t vertex, double u, double v, double weight) {
    v1::UvPin& added = *request.add_pins();
    added.set_vertex(vertex);
    added.set_u(u);
    added.set_v(v);
    added.set_weight(weight);
  };
  pin(0, 7, -3, 0);
  pin(30, 7.5, -3.25, 0);
  const v1::FlattenResponse hard = Flat(request);
  EXPECT_LT(std::abs(Positions(hard)[0] - Complex(7, -3)), 1e-12);
  EXPECT_LT(std::abs(Positions(hard)[30] - Complex(7.5, -3.25)), 1e-12);
  EXPECT_THAT(hard.anchor_vertices(), IsEmpty());
  request.clear_pins();
  pin(0, 7, -3, 1e-3);
  pin(30, 7.5, -3.25, 1e-3);
  const double loose = std::abs(Positions(Flat(request))[30] - Complex(7.5, -3.25));
  request.clear_pins();
  pin(0, 7, -3, 1e3);
  pin(30, 7.5, -3.25, 1e3);
  const double tight = std::abs(Positions(Flat(request))[30] - Complex(7.5, -3.25));
  EXPECT_GT(loose, 0);
  EXPECT_LT(tight, 0.5 * loose);
}

TEST_F(FlattenOptionTest, GrainLinesKeepTheirDirection) {
  for (const double degrees : {0.0, 30.0, -135.0, 360.0 + 90.0}) {
    v1::FlattenRequest request = RequestFor(Cap());
    request.set_float64(true);
    v1::GrainLine& line = *request.add_grain_lines();
    line.set_from_vertex(0);
    line.set_to_vertex(40);
    line.set_angle_degrees(degrees);
    const std::vector<Complex> uv = Positions(Flat(request));
    const Complex expected = std::polar(1.0, degrees * std::acos(-1.0) / 180);
    const Complex actual = (uv[40] - uv[0]) / std::abs(uv[40] - uv[0]);
    EXPECT_LT(std::abs(actual - expected), 1e-9) << degrees;
  }
}

TEST_F(FlattenOptionTest, RigidityTakesTheStretchElsewhere) {
  v1::FlattenRequest request = RequestFor(Cap());
  const auto stretch_of_half = [&](const v1::FlattenResponse& response) {
    double sum = 0;
    for (int i = 0; i < response.singular_values_size() / 2; ++i) {
      sum += std::abs(response.singular_values(i) - 1);
    }
    return sum;
  };
  request.set_include_singular_values(true);
  request.set_refine(0);
  const double even = stretch_of_half(Flat(request));
  const int triangles = request.mesh().triangles_size() / 3;
  for (int t = 0; t < triangles; ++t) {
    request.mutable_energy()->add_rigidity(t < triangles / 2 ? 100 : 1);
  }
  EXPECT_LT(stretch_of_half(Flat(request)), 0.8 * even);
}

}  // namespace
}  // namespace arap::wire
