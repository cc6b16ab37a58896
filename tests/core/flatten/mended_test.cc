// Surfaces that were mended before they are laid flat.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <gmock/gmock.h>

#include "tests/core/flatten/fixture.h"

namespace arap::testing::mended {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// A quarter tube of radius 20 and length 30 in 6 × 3 cells between two angles; adds to `mesh`.
void AddTube(double from, double to, std::uint32_t nx, std::uint32_t ny, SurfaceMesh& mesh) {
  const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
  for (std::uint32_t j = 0; j <= ny; ++j) {
    for (std::uint32_t i = 0; i <= nx; ++i) {
      const double angle = from + (to - from) * i / nx;
      mesh.vertices.push_back({20 * std::cos(angle), 20 * std::sin(angle), 30.0 * j / ny});
    }
  }
  for (std::uint32_t j = 0; j < ny; ++j) {
    for (std::uint32_t i = 0; i < nx; ++i) {
      const std::uint32_t v = base + (nx + 1) * j + i;
      mesh.triangles.push_back({v, v + 1, v + nx + 2});
      mesh.triangles.push_back({v, v + nx + 2, v + nx + 1});
    }
  }
}
constexpr double kQuarter = std::numbers::pi / 2;
constexpr double kWidth = 31.326;  // of six chords

SurfaceMesh Whole() {
  SurfaceMesh mesh;
  AddTube(0, kQuarter, 6, 3, mesh);
  return mesh;
}
SurfaceMesh Halves(std::uint32_t rows = 3) {
  SurfaceMesh mesh;
  AddTube(0, kQuarter / 2, 3, rows, mesh);
  AddTube(kQuarter / 2, kQuarter, 3, 3, mesh);
  return mesh;
}
SurfaceMesh Soup(const SurfaceMesh& mesh) {
  SurfaceMesh soup;
  for (const Triangle& t : mesh.triangles) {
    const auto v = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t corner : t) soup.vertices.push_back(mesh.vertices[corner]);
    soup.triangles.push_back({v, v + 1, v + 2});
  }
  return soup;
}

std::vector<std::string> Kinds(const Flattening& flat) {
  std::vector<std::string> kinds;
  for (const Warning& warning : flat.warnings) kinds.push_back(warning.kind);
  return kinds;
}

Flattening Flat(const SurfaceMesh& mesh, const RepairOptions& repair) {
  FlattenOptions options = Refined();
  options.cut.repair = repair;
  return Must(Flatten(mesh, options));
}

// The answer is about the mesh that was given, and every corner lies where its vertex does.
void ExpectOfGiven(const SurfaceMesh& mesh, const Flattening& flat) {
  ASSERT_THAT(flat.corner_uv, SizeIs(mesh.triangles.size()));
  ASSERT_THAT(flat.triangle_chart, SizeIs(mesh.triangles.size()));
  ASSERT_THAT(flat.singular_values, SizeIs(mesh.triangles.size()));
  ASSERT_EQ(flat.source.size(), flat.uv.size());
  std::size_t counted = 0;
  for (const FlatChart& chart : flat.charts) counted += chart.triangles;
  EXPECT_EQ(counted, mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[t][k];
      EXPECT_EQ(flat.source[flat.corner_uv[t][k]], flat.welded.empty() ? v : flat.welded[v]);
    }
  }
}

void ExpectOnePiece(const SurfaceMesh& mesh, const Flattening& flat, double width, double height) {
  ExpectOfGiven(mesh, flat);
  EXPECT_THAT(flat.charts, SizeIs(1));
  double w = 0, h = 0;
  for (const auto& corners : flat.corner_uv) {
    for (const std::uint32_t u : corners) {
      w = std::max(w, flat.uv[u].real());
      h = std::max(h, flat.uv[u].imag());
    }
  }
  EXPECT_NEAR(w, width, 2e-3);
  EXPECT_NEAR(h, height, 2e-3);
  EXPECT_LE(flat.distortion.arap_energy, 1e-12);
}

TEST(MendedSurfaces, TwinsAreToldAndWelded) {
  const SurfaceMesh mesh = Halves();
  const Flattening open = Flat(mesh, {});
  EXPECT_THAT(open.charts, SizeIs(2));
  ASSERT_THAT(Kinds(open), ElementsAre("twin_vertices"));
  EXPECT_EQ(open.warnings[0].count, 4u);
  EXPECT_THAT(open.warnings[0].message, HasSubstr("weld joins it"));

  const Flattening flat = Flat(mesh, {.weld = true});
  ExpectOnePiece(mesh, flat, kWidth, 30);
  EXPECT_THAT(Kinds(flat), ElementsAre("welded_vertices"));
  ASSERT_THAT(flat.welded, SizeIs(mesh.vertices.size()));
  EXPECT_EQ(flat.welded[16], 3u);
  EXPECT_EQ(flat.uv[16], flat.uv[3]);
}

TEST(MendedSurfaces, SoupsAreToldAndWelded) {
  const SurfaceMesh mesh = Soup(Whole());
  const Flattening open = Flat(mesh, {});
  EXPECT_THAT(open.charts, SizeIs(36));
  ASSERT_THAT(Kinds(open), ElementsAre("twin_vertices"));
  EXPECT_EQ(open.warnings[0].count, 80u);
  ExpectOnePiece(mesh, Flat(mesh, {.weld = true}), kWidth, 30);
}

TEST(MendedSurfaces, TJunctionsAreToldAndStitched) {
  // Three rows meet two; the ends are twins.
  const SurfaceMesh mesh = Halves(2);
  EXPECT_THAT(Kinds(Flat(mesh, {})), Contains("t_junctions"));
  FlattenOptions welded = Refined();
  welded.cut.repair.weld = true;
  const auto open = Flatten(mesh, welded);
  ASSERT_FALSE(open);
  EXPECT_EQ(open.error().kind, FaultKind::kNonManifoldVertex);
  EXPECT_THAT(open.error().message, HasSubstr("3 T-junctions"));
  EXPECT_THAT(open.error().message, HasSubstr("stitch joins it"));
  const Flattening flat = Flat(mesh, {.weld = true, .stitch = true});
  ExpectOnePiece(mesh, flat, kWidth, 30);
  EXPECT_THAT(Kinds(flat), ElementsAre("welded_vertices", "split_triangles"));
  // Where it is split it can be a seam, by the vertices of the edge as it was given: 3-7, 7-11 on the left.
  FlattenOptions options = Refined();
  options.cut.repair = {.weld = true, .stitch = true};
  options.cut.seams = {{3, 7}, {7, 11}};
  const Flattening cut = Must(Flatten(mesh, options));
  EXPECT_THAT(cut.charts, SizeIs(2));
  EXPECT_THAT(cut.cuts, SizeIs(4));
  ExpectOfGiven(mesh, cut);
  // What was cut can be cut again.
  options.cut.seams = cut.cuts;
  EXPECT_EQ(Must(Flatten(mesh, options)).corner_uv, cut.corner_uv);
}

TEST(MendedSurfaces, DoubledFacesAndBothSidesAreDropped) {
  SurfaceMesh mesh = Whole();
  const std::size_t single = mesh.triangles.size();
  for (std::size_t t = 0; t < single; ++t) {
    const auto [a, b, c] = mesh.triangles[t];
    mesh.triangles.push_back({c, b, a});
  }
  FlattenOptions options = Refined();
  const auto refused = Flatten(mesh, options);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("36 such in all; 36 of them run the other way"));
  const Flattening flat = Flat(mesh, {.drop_duplicates = true});
  ExpectOnePiece(mesh, flat, kWidth, 30);
  EXPECT_THAT(Kinds(flat), ElementsAre("dropped_triangles"));
  EXPECT_THAT(flat.welded, IsEmpty());
}

TEST(MendedSurfaces, WishesNameWhatWasGiven) {
  const SurfaceMesh mesh = Halves();
  FlattenOptions options = Refined();
  options.cut.repair.weld = true;
  options.pins = {{16, {100, 50}, 0}, {28, {100, 80}, 0}};  // twins of 3 and 15
  options.energy.rigidity.assign(mesh.triangles.size(), 2);
  const Flattening flat = Must(Flatten(mesh, options));
  EXPECT_LE(std::abs(flat.uv[3] - Complex(100, 50)), 1e-9);
  EXPECT_LE(std::abs(flat.uv[16] - Complex(100, 50)), 1e-9);
  EXPECT_LE(std::abs(flat.uv[15] - Complex(100, 80)), 1e-9);
  // Prepared or at once, with the same bytes.
  const auto prepared = Must(Prepare(mesh, options.cut));
  EXPECT_EQ(Must(Flatten(*prepared, options)).uv, flat.uv);
  options.energy.rigidity.pop_back();
  EXPECT_EQ(Flatten(mesh, options).error().kind, FaultKind::kArrayLength);
}

TEST(MendedSurfaces, FaultsSayWhatARepairCouldDo) {
  // A whole tube that is closed but for a seam of T-junctions, with its ends shut by nothing: two borders.
  SurfaceMesh mesh = Halves();
  mesh.triangles.push_back({0, 1, 22});
  const auto fault = Flatten(mesh, Refined());
  ASSERT_FALSE(fault);
  EXPECT_EQ(fault.error().kind, FaultKind::kNonManifoldVertex);
  EXPECT_THAT(fault.error().message, HasSubstr("weld joins it"));
}

TEST(MendedSurfaces, EstimatesHoldForWhatIsWelded) {
  const SurfaceMesh soup = Soup(Whole());
  CutOptions cut;
  const SurfaceSize apart = SizeOf(soup, cut);
  EXPECT_EQ(apart.largest, 3u);
  cut.repair.weld = true;
  const SurfaceSize welded = SizeOf(soup, cut);
  EXPECT_EQ(welded.charts, 1u);
  EXPECT_GE(welded.largest, Whole().vertices.size());
}

}  // namespace
}  // namespace arap::testing::mended
