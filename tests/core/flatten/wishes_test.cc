// Pins and grain lines: where the caller wants the layout.
#include "core/flatten/layout/wishes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/cut/cut_surface.h"
#include "core/flatten/chart.h"
#include "tests/core/flatten/fixture.h"
#include "tests/support/surfaces.h"

namespace arap::testing {
namespace {

TEST(WishesTest, HardPinsAreMetExactly) {
  const SurfaceMesh cap = SphereCap(8, 20, 1.2);
  FlattenOptions options = Refined();
  options.pins = {{3, {10, 20}, 0}, {50, {11, 20.5}, 0}, {120, {10.2, 21}, 0}};
  const Flattening flat = Must(Flatten(cap, options));
  CheckSound(cap, flat);
  for (const UvPin& pin : options.pins) EXPECT_EQ(flat.uv[pin.vertex], pin.uv);
  EXPECT_TRUE(flat.charts[0].anchors.empty());
}

// A developable pinned where it would lie anyway stays exact, turned and moved as the pins say.
TEST(WishesTest, PinsPlaceADevelopable) {
  const Developable made = Accordion(8, 6, 4, 1, 2.4, 2);
  const Complex turn = std::polar(1.0, 2.1), shift(7, -3);
  for (const double weight : {0.0, 10.0}) {
    FlattenOptions options;
    for (const std::uint32_t v : {0u, 17u, 40u}) {
      options.pins.push_back({v, turn * made.flat[v] + shift, weight});
    }
    const Flattening flat = Must(Flatten(made.surface, options));
    for (std::size_t v = 0; v < made.flat.size(); ++v) {
      EXPECT_LE(std::abs(flat.uv[v] - (turn * made.flat[v] + shift)), 1e-8) << weight;
    }
  }
}

TEST(WishesTest, SoftPinsPullTheHarderTheHeavier) {
  const SurfaceMesh cap = SphereCap(8, 20, 1.2);
  const Flattening free = Must(Flatten(cap, Refined()));
  double last = 1e300;
  for (const double weight : {0.1, 1.0, 10.0, 1e6}) {
    FlattenOptions options = Refined();
    options.pins = {{3, free.uv[3], weight}, {100, free.uv[100] + Complex(0.5, 0), weight}};
    const Flattening flat = Must(Flatten(cap, options));
    const double miss =
        std::abs(flat.uv[3] - options.pins[0].uv) + std::abs(flat.uv[100] - options.pins[1].uv);
    EXPECT_LT(miss, last) << weight;
    last = miss;
  }
  EXPECT_LE(last, 1e-4);
}

TEST(WishesTest, OnePinMovesTheLayout) {
  const SurfaceMesh cap = SphereCap(6, 12, 1.2);
  const Flattening free = Must(Flatten(cap, Refined()));
  FlattenOptions options = Refined();
  options.pins = {{20, {100, 50}, 0}};
  const Flattening flat = Must(Flatten(cap, options));
  EXPECT_EQ(flat.uv[20], Complex(100, 50));
  for (std::size_t v = 0; v < flat.uv.size(); ++v) {
    EXPECT_LE(std::abs(flat.uv[v] - free.uv[v] - (Complex(100, 50) - free.uv[20])), 1e-9);
  }
}

TEST(WishesTest, AGrainLineHasItsDirection) {
  const SurfaceMesh cap = SphereCap(6, 12, 1.2);
  for (const double angle : {0.0, 0.5 * std::numbers::pi, -2.5}) {
    FlattenOptions options = Refined();
    options.grain_lines = {{5, 40, angle}};
    const Flattening flat = Must(Flatten(cap, options));
    const Complex along = flat.uv[40] - flat.uv[5];
    EXPECT_LE(std::abs(along / std::abs(along) - std::polar(1.0, angle)), 1e-12);
  }
}

TEST(WishesTest, WrongPinsAndGrainLinesAreNamed) {
  const SurfaceMesh cap = SphereCap(6, 12, 1.2);
  const auto fault = [&](std::vector<UvPin> pins, std::vector<GrainLine> lines) {
    FlattenOptions options;
    options.pins = std::move(pins);
    options.grain_lines = std::move(lines);
    const auto flat = Flatten(cap, options);
    EXPECT_FALSE(flat.has_value());
    return flat ? Fault{} : flat.error();
  };
  const double nan = std::nan("");
  EXPECT_EQ(fault({{9999, 0, 0}}, {}).kind, FaultKind::kIndexOutOfRange);
  EXPECT_EQ(fault({{9999, 0, 0}}, {}).field, "pins[0].vertex");
  EXPECT_EQ(fault({{1, 0, 0}, {2, {nan, 0}, 0}}, {}).field, "pins[1].u");
  EXPECT_EQ(fault({{1, 0, 0}, {2, {0, nan}, 0}}, {}).field, "pins[1].v");
  EXPECT_EQ(fault({{1, 0, 0}, {2, {nan, 0}, 0}}, {}).message, "pins[1].u is NaN or infinite.");
  EXPECT_EQ(fault({{1, 0, 1e-10}}, {}).field, "pins[0].weight");
  EXPECT_EQ(fault({{1, 0, nan}}, {}).field, "pins[0].weight");
  EXPECT_EQ(fault({{1, 0, -1}}, {}).field, "pins[0].weight");
  EXPECT_EQ(fault({{1, 0, 2e9}}, {}).field, "pins[0].weight");
  EXPECT_EQ(fault({{1, 0, 0}, {1, 1, 0}}, {}).field, "pins[1].vertex");
  EXPECT_EQ(fault({{1, 3, 0}, {2, 3, 0}}, {}).kind, FaultKind::kInvalidOption);
  EXPECT_EQ(fault({}, {{1, 1, 0}}).field, "grain_lines[0]");
  EXPECT_EQ(fault({}, {{1, 9999, 0}}).field, "grain_lines[0].to_vertex");
  EXPECT_EQ(fault({}, {{1, 2, nan}}).field, "grain_lines[0].angle");
  EXPECT_EQ(fault({}, {{1, 2, 0}, {3, 4, 0}}).field, "grain_lines[1]");
  EXPECT_EQ(fault({{1, 0, 0}, {2, 1, 0}}, {{3, 4, 0}}).field, "grain_lines[0]");
}

// Before the surface is looked at: everything that is wrong with the options alone.
TEST(WishesTest, WrongOptionsAreNamedFirst) {
  const auto fault = [](const FlattenOptions& options) {
    const auto flat = Flatten(Sphere(6, 8), options);  // which is no disk
    EXPECT_FALSE(flat.has_value());
    return flat ? Fault{} : flat.error();
  };
  FlattenOptions options;
  EXPECT_EQ(fault(options).kind, FaultKind::kNotADisk);
  for (const int refine : {-1, kMaxFlattenRefine + 1}) {
    options.refine = refine;
    EXPECT_EQ(fault(options).field, "refine");
  }
  options = {};
  for (const double stop : {-1e-9, 1.5, std::nan("")}) {
    options.refine_stop = stop;
    EXPECT_EQ(fault(options).field, "refine_stop");
  }
  for (const auto method : {FlattenMethod::kArap, FlattenMethod::kFirstStep, FlattenMethod::kAbf}) {
    options = {};
    options.method = method;
    options.energy.basis = Basis::kVertex;
    EXPECT_EQ(fault(options).field, "energy.basis");
  }
  options.energy.basis = Basis::kEdge;
  EXPECT_EQ(fault(options).message, "Angle-based flattening takes FACE cells only.");
  options.energy = {Basis::kFace, Weights::kUniform, {}};
  EXPECT_EQ(fault(options).field, "energy.weights");
  options = {};
  options.energy.rigidity = {1};
  EXPECT_EQ(fault(options).field, "energy.rigidity");
}

// Far pins would round the layout away; a wound vertex is no layout without flips.
// The caller is asked once in a fixed number of steps, so that its answers count the work.
TEST(WishesTest, ManyGrainLinesOnOneEdgeAreFoundInOnePass) {
  constexpr std::uint32_t kPages = 3000;
  SurfaceMesh book{{{0, 0, 0}, {0, 1, 0}}, {}};
  FlattenOptions options;
  options.cut.split_non_manifold = true;
  for (std::uint32_t page = 0; page < kPages; ++page) {
    book.vertices.push_back({std::cos(1e-3 * page), 0, std::sin(1e-3 * page)});
    book.triangles.push_back({0, 1, page + 2});
    options.grain_lines.push_back({page % 2, 1 - page % 2, 0.5});
  }
  CutSurface cut = Must(CutToCharts(book, options.cut));
  const std::vector<Chart> charts = Must(MakeCharts(cut));
  std::size_t asked = 0;
  const CancelToken cancel([&asked]() -> Status {
    ++asked;
    return {};
  });
  const auto wishes = Must(FindWishes(charts, cut.source, book.vertices.size(), options, cancel));
  ASSERT_EQ(wishes.size(), kPages);
  for (const Wishes& one : wishes) EXPECT_TRUE(one.grain);
  EXPECT_GT(asked, 0u);
  EXPECT_LT(asked, 20u);
}

TEST(WishesTest, FarPinsAreRefused) {
  const SurfaceMesh both = Together(SphereCap(3, 6, 1.0), SphereCap(3, 6, 1.0), {5, 0, 0});
  FlattenOptions options;
  options.pins = {{1, {1e7, 0}, 0}};
  const auto far = Flatten(both, options);
  ASSERT_FALSE(far.has_value());
  EXPECT_EQ(far.error().field, "pins[0]");
  options.pins = {{1, {1e5, 0}, 0}};
  const Flattening flat = Must(Flatten(both, options));
  EXPECT_EQ(flat.uv[1], Complex(1e5, 0));
  EXPECT_EQ(flat.distortion.flipped, 0u);
  EXPECT_FALSE(flat.overlaps);
}

// Pins and grain lines on the seam keep to one side of it.
TEST(WishesTest, WishesOnASeamKeepToOneSide) {
  auto [band, cut] = Band();
  for (const std::size_t turn : {0u, 50u, 97u}) {
    std::rotate(band.triangles.begin(), band.triangles.begin() + static_cast<long>(turn),
                band.triangles.end());
    FlattenOptions options = Refined();
    options.cut = cut;
    options.grain_lines = {{0, kAcross, 0.3}};
    Flattening flat = Must(Flatten(band, options));
    // The seam is straight and its two copies are parallel: whichever it was, a side has the angle.
    for (const auto& t : flat.corner_uv) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = t[k], b = t[(k + 1) % 3];
        if (flat.source[a] != 0 || flat.source[b] != 1) continue;
        EXPECT_NEAR(std::arg(flat.uv[b] - flat.uv[a]), 0.3, 1e-9) << turn;
      }
    }
    options.grain_lines.clear();
    options.pins = {{0, {5, 5}, 0}};
    flat = Must(Flatten(band, options));
    EXPECT_EQ(flat.uv[0], Complex(5, 5));
    EXPECT_LE(flat.distortion.max_stretch_percent, 1e-6);
  }
}

}  // namespace
}  // namespace arap::testing
