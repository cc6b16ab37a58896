// Flatten over the wire: surface_key saves work and changes nothing.

#include "tests/support/bounded.h"
#include "tests/support/surfaces.h"
#include "tests/system/wire/flatten_fixture.h"

namespace arap::wire {
namespace {

class PreparedSurfaceTest : public FlattenTest {
 protected:
  static v1::FlattenRequest Keyed(const char* key) {
    v1::FlattenRequest request = RequestFor(testing::SphereCap(6, 14, 1.6));
    request.set_surface_key(key);
    request.set_float64(true);
    return request;
  }
  bool Cached(const v1::FlattenRequest& request) { return Flat(request).surface_cached(); }
  // All that the request decides.
  std::string Bytes(v1::FlattenRequest request, const char* key) {
    request.set_surface_key(key);
    v1::FlattenResponse response = Flat(request);
    response.clear_queue_time();
    response.clear_solve_time();
    response.clear_surface_cached();
    return response.SerializeAsString();
  }
};

TEST_F(PreparedSurfaceTest, SecondTimeHits) {
  EXPECT_FALSE(Cached(Keyed("a")));
  EXPECT_TRUE(Cached(Keyed("a")));
  EXPECT_FALSE(Cached(Keyed(""))) << "without a key nothing is looked up";
  EXPECT_FALSE(Cached(Keyed("b"))) << "another key is another place";
}

TEST_F(PreparedSurfaceTest, KeptSurfaceChangesNoAnswer) {
  // One after the other under one key, so that what one leaves behind meets the next.
  const v1::FlattenRequest plain = Keyed("");
  std::vector<v1::FlattenRequest> requests(10, plain);
  requests[1].set_method(v1::FLATTEN_METHOD_LSCM);
  requests[2].set_method(v1::FLATTEN_METHOD_ARAP_EDGE);
  requests[3].set_method(v1::FLATTEN_METHOD_ARAP_EDGE);
  requests[3].mutable_energy()->set_weights(v1::EDGE_WEIGHTS_UNIFORM);
  for (int t = 0; t < plain.mesh().triangles_size() / 3; ++t) {
    requests[4].mutable_energy()->add_rigidity(t % 3 == 0 ? 20 : 1);
  }
  for (const int i : {5, 6, 7}) {
    for (const std::uint32_t vertex : {3u, i == 7 ? 44u : 50u}) {
      v1::UvPin& pin = *requests[static_cast<std::size_t>(i)].add_pins();
      pin.set_vertex(vertex);
      pin.set_u(0.01 * vertex * i);
    }
  }
  requests[6].mutable_pins(1)->set_weight(3);
  requests[8].set_anchors(v1::FLATTEN_ANCHORS_FAR_BOUNDARY);
  requests[9].set_method(v1::FLATTEN_METHOD_ABF);
  for (int round = 0; round < 2; ++round) {
    for (std::size_t i = 0; i < requests.size(); ++i) {
      v1::FlattenRequest keyed = requests[i];
      keyed.set_surface_key("key");
      const v1::FlattenResponse kept = Flat(keyed);
      const v1::FlattenResponse fresh = Flat(requests[i]);
      EXPECT_EQ(Positions(kept), Positions(fresh)) << i;
      EXPECT_EQ(kept.distortion().arap_energy(), fresh.distortion().arap_energy()) << i;
      EXPECT_EQ(kept.charts(0).refinements(), fresh.charts(0).refinements()) << i;
    }
  }
  for (v1::FlattenRequest& request : requests) {
    request.set_surface_key("key");
    EXPECT_TRUE(Cached(request)) << "none of them asks for another surface";
  }
}

TEST_F(PreparedSurfaceTest, OtherContentTakesThePlace) {
  const v1::FlattenRequest first = Keyed("a");
  v1::FlattenRequest moved = first;
  moved.mutable_mesh()->set_vertices(0, 0.001);
  v1::FlattenRequest seam = first;
  for (const std::uint32_t v : {0u, 1u, 1u, 15u, 15u, 29u}) seam.add_seam_edges(v);
  v1::FlattenRequest cut = first;
  cut.set_auto_cut(true);
  v1::FlattenRequest split = first;
  split.set_split_non_manifold(true);
  v1::FlattenRequest tolerant = first;
  tolerant.set_tolerate_degenerate(true);
  for (const v1::FlattenRequest& request : {first, moved, seam, cut, split, tolerant, first}) {
    EXPECT_FALSE(Cached(request));
    EXPECT_TRUE(Cached(request));
  }
  EXPECT_EQ(host().engine().surfaces.entries(), 1u);
  EXPECT_TRUE(Bytes(moved, "a") == Bytes(moved, ""));
}

TEST_F(PreparedSurfaceTest, LongestUnusedGoesFirst) {
  options().limits.max_cached_surfaces = 2;
  EXPECT_FALSE(Cached(Keyed("a")));
  EXPECT_FALSE(Cached(Keyed("b")));
  EXPECT_TRUE(Cached(Keyed("a")));
  EXPECT_FALSE(Cached(Keyed("c")));
  EXPECT_TRUE(Cached(Keyed("a")));
  EXPECT_FALSE(Cached(Keyed("b")));
}

TEST_F(PreparedSurfaceTest, NoPlacesNoCache) {
  options().limits.max_cached_surfaces = 0;
  EXPECT_FALSE(Cached(Keyed("a")));
  EXPECT_FALSE(Cached(Keyed("a")));
  EXPECT_EQ(host().engine().surfaces.bytes(), 0u);
}

TEST_F(PreparedSurfaceTest, RefusedOptionsKeepTheSurface) {
  v1::FlattenRequest request = Keyed("a");
  request.add_pins()->set_vertex(100'000);
  v1::FlattenResponse response;
  EXPECT_EQ(Flatten(request, &response).error_code(), grpc::INVALID_ARGUMENT);
  EXPECT_TRUE(Cached(Keyed("a")));
  request = Keyed("b");
  request.mutable_mesh()->set_triangles(0, 100'000);
  Refusal(request, grpc::INVALID_ARGUMENT, "INDEX_OUT_OF_RANGE");
  EXPECT_EQ(host().engine().surfaces.entries(), 1u) << "what is no surface is not kept";
}

TEST_F(PreparedSurfaceTest, ManyAtOnce) {
  options().lanes = {2, 4};
  options().limits.max_queued_jobs = 64;
  const std::string expected = Bytes(Keyed(""), "");
  std::vector<testing::BoundedThread> threads;
  threads.reserve(4);
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back("a caller", [&, i] {
      for (int k = 0; k < 6; ++k) {
        v1::FlattenRequest request = Keyed("");
        if (k % 3 == 2) request.set_method(v1::FLATTEN_METHOD_LSCM);
        const std::string answer = Bytes(request, i % 2 == 0 ? "a" : "b");
        if (k % 3 != 2) {
          EXPECT_TRUE(answer == expected) << "bytes differ";
        }
      }
    });
  }
  threads.clear();
  EXPECT_EQ(host().engine().surfaces.entries(), 2u);
}

}  // namespace
}  // namespace arap::wire
