// What a flattening is said to take, and what it takes.
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <malloc.h>
#include <sys/resource.h>

#include "tests/core/flatten/fixture.h"

namespace arap::testing {
namespace {

constexpr double kMegabyte = 1 << 20;

// A bumpy sheet of n × n cells, moved along x.
SurfaceMesh Sheet(std::uint32_t n, double x) {
  SurfaceMesh mesh;
  for (std::uint32_t i = 0; i <= n; ++i) {
    for (std::uint32_t j = 0; j <= n; ++j) {
      const double u = static_cast<double>(i) / n, v = static_cast<double>(j) / n;
      mesh.vertices.push_back({x + u, v, u * (1 - u) + 0.05 * std::sin(9 * u) * std::cos(7 * v)});
    }
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t a = i * (n + 1) + j, b = a + n + 1;
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
    }
  }
  return mesh;
}

SurfaceMesh Sheets(std::uint32_t count, std::uint32_t n) {
  SurfaceMesh mesh;
  for (std::uint32_t k = 0; k < count; ++k) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    const SurfaceMesh one = Sheet(n, 1.5 * k);
    mesh.vertices.insert(mesh.vertices.end(), one.vertices.begin(), one.vertices.end());
    for (const Triangle& t : one.triangles) {
      mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
  }
  return mesh;
}

TEST(SurfaceSizeTest, CountsCharts) {
  const SurfaceSize size = SizeOf(Sheets(3, 4));
  EXPECT_EQ(size.vertices, 75u);
  EXPECT_EQ(size.triangles, 96u);
  EXPECT_EQ(size.charts, 3u);
  EXPECT_EQ(size.largest, 25u);
}

TEST(SurfaceSizeTest, PartsThatOnlyTouchAreSplitWhereTheCutSplitsThem) {
  SurfaceMesh fan{{{0, 0, 0}}, {}};
  for (std::uint32_t k = 0; k < 50; ++k) {
    fan.vertices.push_back({1, 0.02 * k, 0});
    fan.vertices.push_back({1, 0.02 * k + 0.01, 0});
    fan.triangles.push_back({0, 2 * k + 1, 2 * k + 2});
  }
  EXPECT_EQ(SizeOf(fan).charts, 1u);
  CutOptions cut;
  cut.split_non_manifold = true;
  EXPECT_EQ(SizeOf(fan, cut).charts, 50u);
}

TEST(SurfaceSizeTest, TakesWhatIsNoMesh) {
  const SurfaceMesh wrong{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 0, 1}, {7, 8, 9}}};
  EXPECT_EQ(SizeOf(wrong).charts, 1u);
  CutOptions cut;
  cut.split_non_manifold = true;
  EXPECT_EQ(SizeOf(wrong, cut).charts, 1u);
  EXPECT_EQ(SizeOf({}).charts, 0u);
}

TEST(FlattenCostTest, GrowsWithWhatIsAsked) {
  const SurfaceSize small{5000, 9800, 1, 5000}, large{50'000, 99'000, 1, 50'000};
  SurfaceSize torn = large;
  torn.charts = 10'000;
  const FlattenCost plain = EstimateFlatten(large, ArapOptions());
  EXPECT_LT(EstimateFlatten(small, ArapOptions()).milliseconds, plain.milliseconds);
  EXPECT_LT(EstimateFlatten(small, ArapOptions()).bytes, plain.bytes);
  EXPECT_LT(plain.milliseconds, EstimateFlatten(torn, ArapOptions()).milliseconds);
  EXPECT_LT(plain.bytes, EstimateFlatten(torn, ArapOptions()).bytes);
  EXPECT_LT(plain.bytes, EstimateFlatten(large, ArapOptions(), true).bytes);
  const auto costs_more = [&](auto change) {
    FlattenOptions options = ArapOptions();
    change(options);
    return EstimateFlatten(large, options).milliseconds > plain.milliseconds;
  };
  EXPECT_TRUE(costs_more([](FlattenOptions& o) { o.refine_stop = 0; }));
  EXPECT_TRUE(costs_more([](FlattenOptions& o) { o.energy.basis = Basis::kEdge; }));
  EXPECT_TRUE(costs_more([](FlattenOptions& o) { o.anchors = FlattenAnchors::kSpectral; }));
  EXPECT_TRUE(costs_more([](FlattenOptions& o) { o.injective = true; }));
  EXPECT_TRUE(costs_more([](FlattenOptions& o) { o.pins.resize(8); }));
  EXPECT_TRUE(costs_more([](FlattenOptions& o) { o.cut.auto_cut = true; }));
  EXPECT_GT(EstimateFlatten(large, AbfOptions()).milliseconds, plain.milliseconds);
}

// Resident memory, bytes; nothing where the system does not say or cannot begin anew.
std::optional<double> ResidentBytes(const char* what) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double kilobytes = 0;
    if (word == what && status >> kilobytes) return 1024 * kilobytes;
  }
  return std::nullopt;
}
bool ForgetPeak() {
  std::ofstream file("/proc/self/clear_refs");
  file << "5" << std::flush;
  return file.good();
}

FlattenOptions CentreEdge(FlattenOptions options) {
  options.anchors = FlattenAnchors::kCentreEdge;
  return options;
}

TEST(FlattenCostTest, SaysTheMemoryWithinAThird) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "A sanitizer needs memory of its own.";
#endif
  const std::vector<std::pair<const char*, FlattenOptions>> methods{
      {"ARAP", ArapOptions()},
      {"ARAP, EDGE cells", ArapOptions(Basis::kEdge)},
      {"LSCM", LscmOptions()},
      {"LSCM, centre edge", CentreEdge(LscmOptions())},
      {"ABF", AbfOptions()}};
  for (const auto& mesh : {Sheet(120, 0), Sheets(20, 40), Sheets(4000, 1)}) {
    for (const auto& [name, options] : methods) {
      const double said = static_cast<double>(EstimateFlatten(SizeOf(mesh), options).bytes);
      malloc_trim(0);
      const auto before = ResidentBytes("VmRSS:");
      if (!before || !ForgetPeak()) GTEST_SKIP() << "The system does not tell the peak.";
      ASSERT_TRUE(Flatten(mesh, options));
      const double taken = ResidentBytes("VmHWM:").value_or(0) - *before;
      EXPECT_LT(taken, 1.3 * said + 2 * kMegabyte) << name << ", " << mesh.triangles.size();
      EXPECT_LT(said, 1.3 * taken + 3 * kMegabyte) << name << ", " << mesh.triangles.size();
    }
  }
}

// With what stays until the next flattening of the surface.
TEST(FlattenCostTest, SaysTheMemoryOfSurfacesThatAreKept) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "A sanitizer needs memory of its own.";
#endif
  const std::vector<std::pair<const char*, FlattenOptions>> methods{
      {"ARAP", ArapOptions()}, {"LSCM, centre edge", CentreEdge(LscmOptions())}};
  for (const auto& mesh : {Sheet(120, 0), Sheets(20, 40)}) {
    for (const auto& [name, options] : methods) {
      const double said = static_cast<double>(EstimateFlatten(SizeOf(mesh), options, true).bytes);
      malloc_trim(0);
      const auto before = ResidentBytes("VmRSS:");
      if (!before || !ForgetPeak()) GTEST_SKIP() << "The system does not tell the peak.";
      const auto surface = Prepare(mesh, options.cut);
      ASSERT_TRUE(surface && Flatten(**surface, options));
      const double taken = ResidentBytes("VmHWM:").value_or(0) - *before;
      EXPECT_LT(taken, 1.3 * said + 2 * kMegabyte) << name << ", " << mesh.triangles.size();
    }
  }
}

// In a process of its own, with so much room beyond what it has.
TEST(FlattenMemoryDeathTest, MemoryThatRunsOutIsAFault) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "A sanitizer needs memory of its own.";
#endif
  for (const double megabytes : {8, 25, 60}) {
    for (const FlattenOptions& options : {ArapOptions(), AbfOptions()}) {
      const auto flatten = [&] {
        const SurfaceMesh mesh = Sheet(300, 0);
        // What BLAS takes once is taken.
        bool good = Flatten(Sheet(40, 0), options).has_value();
        const auto room =
            static_cast<rlim_t>(ResidentBytes("VmSize:").value_or(0) + megabytes * kMegabyte);
        const rlimit limit{room, room};
        good = good && setrlimit(RLIMIT_AS, &limit) == 0;
        const auto flat = Flatten(mesh, options);
        std::exit(good && !flat && flat.error().kind == FaultKind::kOutOfMemory ? 0 : 1);
      };
      EXPECT_EXIT(flatten(), ::testing::ExitedWithCode(0), "") << megabytes;
    }
  }
}

}  // namespace
}  // namespace arap::testing
