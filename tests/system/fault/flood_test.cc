// More calls than the server wants: the surplus is refused at once, and afterwards all is as
// before.
#include <atomic>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "tests/system/fault/bystander.h"
#include "tests/system/fault/client.h"
#include "tests/system/fault/herd.h"
#include "tests/system/fault/limits.h"
#include "tests/system/fault/server_process.h"

namespace arap::fault {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using std::chrono::steady_clock;

constexpr std::size_t kMaxStreams = 100;
constexpr std::size_t kConnections = 4;
constexpr std::size_t kChunk = 500;

class FloodTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(server_.Start());
    bystander_.emplace(server_.address());
    FaultClient(server_.address()).SetUp(30);
    ASSERT_TRUE(bystander_->GoesOn());
  }

  // Opens `total` streams in chunks over a few connections, one chunk after the other is answered,
  // and ends them all. The bystander has one of the places.
  void FloodWithStreams(Habit habit, std::size_t total) {
    std::vector<std::unique_ptr<FaultClient>> clients;
    std::vector<std::unique_ptr<Herd>> herds;
    for (std::size_t i = 0; i < kConnections; ++i) {
      clients.push_back(std::make_unique<FaultClient>(server_.address()));
      herds.push_back(std::make_unique<Herd>(*clients.back(), HerdOptions{habit}));
    }
    const auto sum = [&](auto count) {
      std::size_t all = 0;
      for (const auto& herd : herds) all += count(*herd);
      return all;
    };
    constexpr std::size_t kAdmitted = kMaxStreams - 1;
    for (std::size_t started = kChunk; started <= total; started += kChunk) {
      for (const auto& herd : herds) herd->Open(kChunk / kConnections);
      // The refused are told at once, although those who were let in go on for ever.
      ASSERT_TRUE(Eventually(
          [&] { return sum([](const Herd& herd) { return herd.ended(); }) == started - kAdmitted; },
          seconds(10)))
          << started << " started";
    }
    EXPECT_EQ(sum([](const Herd& herd) { return herd.ended(grpc::RESOURCE_EXHAUSTED); }),
              total - kAdmitted);
    if (habit == Habit::kIdle) {
      EXPECT_EQ(sum([](const Herd& herd) { return herd.opened(); }), kAdmitted);
    }
    EXPECT_TRUE(bystander_->GoesOn());
    for (const auto& herd : herds) EXPECT_TRUE(herd->End());
  }

  // Here the number of streams is the limit that holds.
  ServerProcess server_{{"--max-streams", std::to_string(kMaxStreams), "--max-stream-load", "0",
                         "--max-stream-fps", "0"}};
  std::optional<Bystander> bystander_;
};

TEST_F(FloodTest, TenThousandStreams) {
  const std::size_t descriptors = server_.Descriptors();
  // What the first flood leaves behind is the allocator's; the second must find it enough.
  FloodWithStreams(Habit::kIdle, 2'000);
  const std::size_t after_first = server_.ResidentBytes();
  FloodWithStreams(Habit::kIdle, 10'000);
  EXPECT_LT(server_.ResidentBytes(), after_first + Megabytes(32));
  EXPECT_TRUE(Eventually([&] { return server_.Descriptors() <= descriptors; }));

  // Every place is free again.
  FaultClient client(server_.address());
  Herd herd(client, {Habit::kIdle});
  herd.Open(kMaxStreams - 1);
  EXPECT_TRUE(Eventually([&] { return herd.opened() == kMaxStreams - 1; }));
}

TEST_F(FloodTest, StreamsThatSayNothingHaveAPlaceToo) { FloodWithStreams(Habit::kSilent, 2'000); }

// Calls through the callback API, so that thousands can be on their way.
template <class Request, class Response>
class CallFlood {
 public:
  // Starts one: `start` is the method of the asynchronous stub.
  template <class Start>
  void Add(const Request& request, std::optional<milliseconds> timeout, Start start) {
    Item& item = *items_.emplace_back(std::make_unique<Item>());
    if (timeout) SetDeadline(item.context, *timeout);
    item.request = request;
    start(&item.context, &item.request, &item.response, [this, &item](const grpc::Status& status) {
      item.status = status;
      ++done_;
    });
  }
  void CancelLast() { items_.back()->context.TryCancel(); }

  bool AwaitAll(milliseconds timeout) {
    return Eventually([this] { return done_ == items_.size(); }, timeout);
  }
  std::size_t Count(grpc::StatusCode code) const {
    std::size_t count = 0;
    for (const auto& item : items_) count += item->status.error_code() == code ? 1u : 0u;
    return count;
  }
  std::size_t size() const { return items_.size(); }

 private:
  struct Item {
    grpc::ClientContext context;
    Request request;
    Response response;
    grpc::Status status;
  };
  std::vector<std::unique_ptr<Item>> items_;
  std::atomic<std::size_t> done_ = 0;
};

TEST_F(FloodTest, CancelledCalls) {
  FaultClient client(server_.address());
  v1::DeformRequest request;
  request.set_session_id("s");
  request.set_handle_set_id("h");
  *request.add_targets() = wire::TargetAt("a", 0, 3);
  *request.add_targets() = wire::TargetAt("b", 30, 0);
  std::size_t after_first = 0;
  for (int round = 0; round < 4; ++round) {
    CallFlood<v1::DeformRequest, v1::DeformResponse> flood;
    for (int call = 0; call < 2'000; ++call) {
      flood.Add(request, seconds(60),
                [&](auto... all) { client.deformation().async()->Deform(all...); });
      if (call % 4 != 0) flood.CancelLast();
    }
    ASSERT_TRUE(flood.AwaitAll(seconds(60)));
    // Whoever was neither cancelled nor served was told that the queue is full.
    EXPECT_EQ(flood.Count(grpc::OK) + flood.Count(grpc::CANCELLED) +
                  flood.Count(grpc::RESOURCE_EXHAUSTED),
              flood.size());
    EXPECT_GT(flood.Count(grpc::CANCELLED), 0u);
    if (round == 0) after_first = server_.ResidentBytes();
  }
  EXPECT_TRUE(Eventually([&] { return server_.ResidentBytes() < after_first + Megabytes(32); },
                         seconds(30)))
      << server_.ResidentBytes() << " bytes, " << after_first << " after the first flood";
  EXPECT_TRUE(bystander_->GoesOn());
  EXPECT_TRUE(
      client.Deform("s", "h", {wire::TargetAt("a", 0, 3), wire::TargetAt("b", 30, 0)}).ok());
}

TEST_F(FloodTest, DeadlinesOfAMillisecond) {
  FaultClient client(server_.address());
  ASSERT_TRUE(client.CreateSession("hasty").ok());
  v1::RegisterMeshRequest request;
  request.set_session_id("hasty");
  *request.mutable_mesh() = wire::Grid(70, 70);
  CallFlood<v1::RegisterMeshRequest, v1::RegisterMeshResponse> flood;
  const auto begin = steady_clock::now();
  for (int call = 0; call < 300; ++call) {
    request.set_mesh_id("m" + std::to_string(call));
    flood.Add(request, milliseconds(1),
              [&](auto... all) { client.deformation().async()->RegisterMesh(all...); });
  }
  ASSERT_TRUE(flood.AwaitAll(seconds(30)));
  EXPECT_GT(flood.Count(grpc::DEADLINE_EXCEEDED), flood.size() / 2);
  EXPECT_EQ(flood.Count(grpc::DEADLINE_EXCEEDED) + flood.Count(grpc::RESOURCE_EXHAUSTED) +
                flood.Count(grpc::OK),
            flood.size());
  // Nobody waits for work that nobody wants any more.
  EXPECT_TRUE(client.Register("s", "wanted", wire::Grid(10, 10)).ok());
  EXPECT_LT(steady_clock::now() - begin, seconds(30));
  EXPECT_TRUE(bystander_->GoesOn());
}

}  // namespace
}  // namespace arap::fault
