// Flatten over the wire: what an answer holds.
#include <cmath>
#include <set>

#include <gmock/gmock.h>

#include "tests/support/compare.h"
#include "tests/support/meshes.h"
#include "tests/support/surfaces.h"
#include "tests/system/wire/flatten_fixture.h"

namespace arap::wire {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST_F(FlattenTest, DevelopableSurfaceUnrollsTrueToSize) {
  v1::FlattenRequest request = RequestFor(BentStrip());
  request.set_include_first_step(true);
  request.set_include_singular_values(true);
  const v1::FlattenResponse response = Flat(request);
  ASSERT_EQ(response.uv_size(), 28);
  EXPECT_EQ(response.uv64_size(), 0);
  EXPECT_EQ(response.uv_vertex_size(), 14);
  EXPECT_EQ(response.first_step_uv_size(), 28);
  EXPECT_EQ(response.singular_values_size(), 24);
  EXPECT_EQ(response.anchor_vertices_size(), 2);
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
  ASSERT_EQ(response.charts_size(), 1);
  ASSERT_EQ(response.charts(0).loops_size(), 1);
  EXPECT_EQ(response.charts(0).loops(0).uv_indices_size(), 14);
  EXPECT_FALSE(response.boundary_overlaps());
  EXPECT_FALSE(response.surface_cached());
  EXPECT_THAT(response.cut_edges(), IsEmpty());
}

TEST_F(FlattenTest, DoublePrecisionOnRequest) {
  v1::FlattenRequest request = RequestFor(BentStrip());
  request.set_float64(true);
  request.set_refine(2);
  const v1::FlattenResponse response = Flat(request);
  EXPECT_EQ(response.uv_size(), 0);
  EXPECT_EQ(response.uv64_size(), 28);
  EXPECT_EQ(response.first_step_uv_size(), 0);
  EXPECT_EQ(response.singular_values_size(), 0);
}

TEST_F(FlattenTest, ComponentsAreChartsOfTheirOwn) {
  v1::FlattenRequest request =
      RequestFor(testing::Together(BentStrip(), testing::SphereCap(4, 12, 1.0), {0, 0, 1}));
  request.set_float64(true);
  const v1::FlattenResponse response = Flat(request);
  ASSERT_EQ(response.charts_size(), 2);
  EXPECT_FALSE(response.boundary_overlaps());
  EXPECT_EQ(response.charts(0).triangle_count(), 12u);
  EXPECT_NEAR(response.charts(0).distortion().arap_energy(), 0, 1e-10);
  EXPECT_GT(response.charts(1).distortion().arap_energy(), 1e-4);
  EXPECT_GE(response.charts(1).distortion().worst_triangle(), 12u)
      << "ids are those of the request";
  EXPECT_EQ(response.distortion().worst_triangle(),
            response.charts(1).distortion().worst_triangle());
  // Apart in the plane.
  const std::vector<Complex> uv = Positions(response);
  double gap = 1e9;
  for (std::size_t a = 0; a < 14; ++a) {
    for (std::size_t b = 14; b < uv.size(); ++b) gap = std::min(gap, std::abs(uv[a] - uv[b]));
  }
  EXPECT_GT(gap, 0.01);
}

TEST_F(FlattenTest, HolesAreLoops) {
  SurfaceMesh ring{{}, testing::Annulus(3, 16, 1, 2).triangles};
  for (const Complex& p : testing::Annulus(3, 16, 1, 2).vertices) {
    ring.vertices.push_back({p.real(), p.imag(), 0});
  }
  const v1::FlattenResponse response = Flat(RequestFor(ring));
  ASSERT_EQ(response.charts_size(), 1);
  ASSERT_EQ(response.charts(0).loops_size(), 2);
  EXPECT_NEAR(response.distortion().arap_energy(), 0, 1e-10);
  const std::vector<Complex> uv = Positions(response);
  std::vector<double> areas;
  for (const v1::FlatLoop& loop : response.charts(0).loops()) {
    double twice = 0;
    for (int i = 0; i < loop.uv_indices_size(); ++i) {
      const Complex a = uv[loop.uv_indices(i)];
      const Complex b = uv[loop.uv_indices((i + 1) % loop.uv_indices_size())];
      twice += std::imag(std::conj(a) * b);
    }
    areas.push_back(twice / 2);
  }
  EXPECT_GT(areas[0], 0) << "the outline comes first, counter-clockwise";
  EXPECT_LT(areas[1], 0) << "a hole runs clockwise";
  EXPECT_GT(areas[0], -areas[1]);
}

TEST_F(FlattenTest, ReversedTrianglesAreTurnedAndKeepTheirCorners) {
  SurfaceMesh mesh = BentStrip();
  std::swap(mesh.triangles[5][1], mesh.triangles[5][2]);
  v1::FlattenRequest request = RequestFor(mesh);
  const v1::FlattenResponse response = Flat(request);
  EXPECT_THAT(Kinds(response), ElementsAre("reversed_triangles"));
  EXPECT_THAT(response.warnings(0).elements(), ElementsAre(5));
  // Without a cut a corner is its vertex, in the order of the request.
  EXPECT_TRUE(std::equal(response.corner_uv().begin(), response.corner_uv().end(),
                         request.mesh().triangles().begin(), request.mesh().triangles().end()));
  EXPECT_EQ(response.distortion().flipped(), 0u);
  EXPECT_NEAR(response.distortion().arap_energy(), 0, 1e-10);
}

TEST_F(FlattenTest, UnreferencedVerticesKeepTheirNumbers) {
  SurfaceMesh mesh = BentStrip();
  mesh.vertices.insert(mesh.vertices.begin() + 3, {5, 5, 5});
  for (Triangle& t : mesh.triangles) {
    for (std::uint32_t& v : t) v += v >= 3;
  }
  const v1::FlattenResponse response = Flat(RequestFor(mesh));
  EXPECT_THAT(Kinds(response), ElementsAre("unreferenced_vertices"));
  EXPECT_THAT(response.warnings(0).elements(), ElementsAre(3));
  EXPECT_EQ(response.uv(6), 0);
  EXPECT_EQ(response.uv(7), 0);
  EXPECT_NEAR(response.distortion().arap_energy(), 0, 1e-10);
}

TEST_F(FlattenTest, OneTriangle) {
  const v1::FlattenResponse response =
      Flat(RequestFor({{{0, 0, 0}, {3, 0, 0}, {0, 0, 4}}, {{0, 1, 2}}}));
  const std::vector<Complex> uv = Positions(response);
  EXPECT_NEAR(std::abs(uv[1] - uv[0]), 3, 1e-5);
  EXPECT_NEAR(std::abs(uv[2] - uv[0]), 4, 1e-5);
  EXPECT_NEAR(std::abs(uv[2] - uv[1]), 5, 1e-5);
}

TEST_F(FlattenTest, SameRequestSameAnswer) {
  v1::FlattenRequest request =
      RequestFor(testing::Together(testing::Sphere(6, 10), BentStrip(), {3, 0, 0}));
  request.set_auto_cut(true);
  request.set_float64(true);
  v1::FlattenResponse first = Flat(request);
  v1::FlattenResponse second = Flat(request);
  for (v1::FlattenResponse* response : {&first, &second}) {
    response->clear_queue_time();
    response->clear_solve_time();
  }
  EXPECT_EQ(first.SerializeAsString(), second.SerializeAsString());
}

}  // namespace
}  // namespace arap::wire
