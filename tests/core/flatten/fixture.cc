#include "tests/core/flatten/fixture.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "core/mesh/space.h"

namespace arap::testing {

FlattenOptions Refined() {
  FlattenOptions options;
  options.refine = 20;
  options.refine_stop = 1e-6;
  return options;
}

void CheckSound(const SurfaceMesh& mesh, const Flattening& flat) {
  ASSERT_EQ(flat.corner_uv.size(), mesh.triangles.size());
  ASSERT_EQ(flat.source.size(), flat.uv.size());
  ASSERT_EQ(flat.singular_values.size(), mesh.triangles.size());
  ASSERT_GE(flat.uv.size(), mesh.vertices.size());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) EXPECT_EQ(flat.source[v], v);
  for (const Complex p : flat.uv) {
    ASSERT_TRUE(std::isfinite(p.real()) && std::isfinite(p.imag()));
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_EQ(flat.source[flat.corner_uv[t][k]], mesh.triangles[t][k]);
    }
  }
  std::size_t triangles = 0;
  for (const FlatChart& chart : flat.charts) {
    triangles += chart.triangles;
    EXPECT_FALSE(chart.loops.empty());
  }
  EXPECT_EQ(triangles, mesh.triangles.size());
}

std::pair<SurfaceMesh, CutOptions> Band() {
  SurfaceMesh band;
  for (std::uint32_t i = 0; i < kAround; ++i) {
    const double angle = 2 * std::numbers::pi * i / kAround;
    for (std::uint32_t j = 0; j <= kAcross; ++j) {
      band.vertices.push_back({std::cos(angle), std::sin(angle), 0.3 * j});
    }
  }
  const auto at = [](std::uint32_t i, std::uint32_t j) {
    return (i % kAround) * (kAcross + 1) + j;
  };
  for (std::uint32_t i = 0; i < kAround; ++i) {
    for (std::uint32_t j = 0; j < kAcross; ++j) {
      band.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      band.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  CutOptions cut;
  for (std::uint32_t j = 0; j < kAcross; ++j) cut.seams.push_back({at(0, j), at(0, j + 1)});
  return {band, cut};
}

std::vector<UvPin> RandomPins(const std::vector<Complex>& free, double diagonal, std::size_t count,
                              PinKind kind, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto next = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  std::vector<UvPin> pins;
  std::vector<bool> taken(free.size());
  while (pins.size() < count) {
    const auto v = static_cast<std::uint32_t>(random() % free.size());
    if (taken[v]) continue;
    taken[v] = true;
    const bool soft = kind == PinKind::kSoft || (kind == PinKind::kMixed && pins.size() % 2 == 1);
    const double weight = soft ? std::pow(10.0, 6 * next() - 3) : 0;
    const double du = next() - 0.5, dv = next() - 0.5;
    pins.push_back({v, free[v] + 0.2 * diagonal * Complex(du, dv), weight});
  }
  return pins;
}

double Diagonal(const SurfaceMesh& mesh) {
  Eigen::Vector3d low = Vec(mesh.vertices.front()), high = low;
  for (const Point3& p : mesh.vertices) {
    low = low.cwiseMin(Vec(p)), high = high.cwiseMax(Vec(p));
  }
  return (high - low).norm();
}

}  // namespace arap::testing
