// Below the wire: the cache of prepared surfaces and the moments at which a flattening can end.
#include "server/flattening/prepared_surfaces.h"

#include <gtest/gtest.h>

#include "tests/support/fake_clock.h"
#include "tests/support/surfaces.h"

namespace arap::app {
namespace {

// A cache of surfaces by itself.
struct Cache {
  Cache(std::size_t entries, std::size_t bytes)
      : derived(std::size_t{1} << 40u, {entries, bytes}, clock) {}

  runtime::FakeClock clock;
  DerivedCache derived;
  runtime::Metrics metrics;
  PreparedSurfaces surfaces{derived, metrics, {}};
};

std::shared_ptr<const PreparedSurface> Prepared(std::size_t sectors) {
  auto surface = Prepare(testing::SphereCap(4, sectors, 1.5), {});
  EXPECT_TRUE(surface);
  return *std::move(surface);
}

TEST(PreparedSurfacesTest, BytesAreBounded) {
  const auto small = Prepared(10);
  const auto large = Prepared(25);
  ASSERT_GT(large->bytes(), 2 * small->bytes());
  Cache room(10, large->bytes());
  room.surfaces.Keep("ann", "a", "1", small);
  room.surfaces.Keep("ann", "b", "1", small);
  EXPECT_EQ(room.surfaces.bytes(), 2 * small->bytes());
  room.surfaces.Keep("ann", "c", "2", large);
  EXPECT_EQ(room.surfaces.entries(), 1u);
  EXPECT_EQ(room.surfaces.bytes(), large->bytes());
  EXPECT_EQ(room.surfaces.Find("ann", "a", "1"), nullptr);
  EXPECT_EQ(room.surfaces.Find("ann", "c", "2"), large);
  EXPECT_EQ(room.surfaces.Find("ann", "c", "3"), nullptr);
  EXPECT_EQ(room.surfaces.Find("ben", "c", "2"), nullptr) << "somebody else's";
  room.surfaces.Keep("ann", "c", "1", small);
  EXPECT_EQ(room.surfaces.entries(), 1u);
  EXPECT_EQ(room.surfaces.bytes(), small->bytes());
  EXPECT_EQ(large.use_count(), 1) << "what is pushed out is freed";
}

TEST(PreparedSurfacesTest, TooLargeIsNotKept) {
  const auto surface = Prepared(10);
  Cache room(10, surface->bytes() - 1);
  room.surfaces.Keep("ann", "a", "1", surface);
  EXPECT_EQ(room.surfaces.entries(), 0u);
  EXPECT_EQ(room.surfaces.bytes(), 0u);
}

TEST(PreparedSurfacesTest, GrowthIsCounted) {
  const auto surface = Prepared(10);
  const std::size_t before = surface->bytes();
  Cache room(10, 1u << 30u);
  room.surfaces.Keep("ann", "a", "1", surface);
  ASSERT_TRUE(Flatten(*surface, {}));
  EXPECT_GT(surface->bytes(), before) << "factors were kept";
  room.surfaces.Keep("ann", "a", "1", surface);
  EXPECT_EQ(room.surfaces.bytes(), surface->bytes());
}

TEST(SurfaceHashTest, TellsContentsApart) {
  const SurfaceMesh mesh = testing::SphereCap(2, 6, 1.0);
  std::vector<CutOptions> cuts(11);
  cuts[1].auto_cut = true;
  cuts[2].split_non_manifold = true;
  cuts[3].tolerate_degenerate = true;
  cuts[4].seams = {{0, 1}};
  cuts[5].seams = {{1, 0}};
  cuts[6].repair.weld = true;
  cuts[7].repair.stitch = true;
  cuts[8].repair.drop_duplicates = true;
  cuts[9].repair.tolerance = 0;
  cuts[10].repair.tolerance = 1e-3;
  std::vector<std::string> hashes;
  for (const CutOptions& cut : cuts) hashes.push_back(*ContentHash(mesh, cut));
  SurfaceMesh moved = mesh;
  moved.vertices[3][2] += 1e-15;
  hashes.push_back(*ContentHash(moved, {}));
  SurfaceMesh turned = mesh;
  std::swap(turned.triangles[0][0], turned.triangles[0][1]);
  hashes.push_back(*ContentHash(turned, {}));
  for (std::size_t i = 0; i < hashes.size(); ++i) {
    for (std::size_t k = i + 1; k < hashes.size(); ++k) EXPECT_NE(hashes[i], hashes[k]);
  }
  EXPECT_EQ(hashes[0], *ContentHash(mesh, {}));
}

// Asked the n-th time, it ends the work.
struct Countdown {
  int left;
  int asked = 0;
  CancelToken token{[this]() -> Status {
    if (++asked > left) return Fail(FaultKind::kCancelled, "The caller has cancelled.");
    return {};
  }};
};

void ExpectEndsWhenever(const SurfaceMesh& mesh, const FlattenOptions& options, int at_least) {
  Countdown free{1 << 20};
  Cache room(4, 1u << 30u);
  ASSERT_TRUE(room.surfaces.Flatten({}, "", mesh, options, free.token));
  EXPECT_GE(free.asked, at_least) << "between the phases and in the long loops";
  for (int n = 0; n < free.asked; ++n) {
    Countdown countdown{n};
    const auto flat = room.surfaces.Flatten({}, n % 2 == 0 ? "" : "key" + std::to_string(n), mesh,
                                            options, countdown.token);
    ASSERT_FALSE(flat) << n;
    EXPECT_EQ(flat.error().kind, FaultKind::kCancelled) << n;
    EXPECT_EQ(countdown.asked, n + 1) << "the first no is enough";
  }
}

TEST(FlattenCancelTest, EveryMomentEndsTheWork) {
  FlattenOptions options;
  options.refine = 12;
  ExpectEndsWhenever(testing::SphereCap(6, 12, 1.8), options, 12);
  options.injective = true;
  ExpectEndsWhenever(testing::SphereCap(6, 12, 2.6), options, 14);
  options = {};
  options.method = FlattenMethod::kAbf;
  ExpectEndsWhenever(testing::SphereCap(6, 12, 1.8), options, 4);
  options = {};
  options.cut.auto_cut = true;
  ExpectEndsWhenever(testing::PlateWithHoles(1, 2), options, 4);
}

}  // namespace
}  // namespace arap::app
