// Everything that happens to a live stream at once: events in any order, threads side by side.
#include <atomic>
#include <cmath>

#include <gtest/gtest.h>

#include "core/base/mutex.h"
#include "server/runtime/worker_pool.h"
#include "tests/server/streams/policy_fixture.h"
#include "tests/support/bounded.h"
#include "tests/support/random.h"

namespace arap::testing {
namespace {

using app::StreamMessage;
using std::chrono::seconds;
using Kind = app::StreamAnswer::Kind;
using Work = app::StreamJob::Work;

TEST(PolicyPropertyTest, AnyEventsKeepThePromises) {
  Random random(11);
  for (int run = 0; run < 3'000; ++run) {
    std::vector<std::uint8_t> bytes(random.Below(400));
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random.Below(256));
    if (!bytes.empty() && run % 4 != 0) bytes[1 % bytes.size()] |= 1u;  // most of them open
    ASSERT_EQ(DrivePolicy(bytes.data(), bytes.size()), "") << "run " << run;
  }
}

// A policy under a lock, with reads, writes, jobs and sweeps on threads of their own, as a reactor
// has it. ThreadSanitizer watches.
class BusyStream {
 public:
  BusyStream(bool latest, std::uint64_t updates) : latest_(latest), updates_(updates) {
    const MutexLock lock(&mutex_);
    Pump();
  }

  // Until it has finished, or for a minute.
  bool Wait() {
    const auto deadline = std::chrono::steady_clock::now() + seconds(60);
    const MutexLock lock(&mutex_);
    while (!finished_) {
      if (changed_.WaitUntil(&mutex_, deadline)) return false;
    }
    return true;
  }

  void Sweep() {
    const MutexLock lock(&mutex_);
    EXPECT_FALSE(policy_.Sweep(clock_.SteadyNow()));
    Pump();
  }

  void Stop() {
    wire_.Stop();
    workers_.Stop();
  }

  std::uint64_t answered() {
    const MutexLock lock(&mutex_);
    return answered_;
  }

 private:
  void Pump() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    for (;;) {
      app::StreamStep step = policy_.Next();
      if (std::holds_alternative<std::monostate>(step)) return;
      if (std::holds_alternative<app::StreamRead>(step)) {
        ASSERT_TRUE(wire_.TryPost([this] { Read(); }));
      } else if (auto* job = std::get_if<app::StreamJob>(&step)) {
        job_ = std::move(*job);
        ASSERT_TRUE(workers_.TryPost([this] { Run(); }));
      } else if (auto* write = std::get_if<app::StreamWrite>(&step)) {
        const auto kind = write->answer.kind;
        if (kind == Kind::kShape || kind == Kind::kError) answered_ += write->answer.replaced + 1;
        ASSERT_TRUE(wire_.TryPost([this] { Written(); }));
      } else {
        finished_ = true;
        changed_.SignalAll();
      }
    }
  }

  void Read() {
    const MutexLock lock(&mutex_);
    if (!opened_) {
      opened_ = true;
      policy_.MessageRead({10, StreamMessage::Open{}});
    } else if (sent_ < updates_) {
      ++sent_;
      policy_.MessageRead(
          {10, StreamMessage::Update{sent_, {At("a", static_cast<double>(sent_), 0)}, {}, {}}});
    } else {
      policy_.HalfClosed();
    }
    Pump();
  }

  void Written() {
    const MutexLock lock(&mutex_);
    policy_.Written(true);
    Pump();
  }

  void Run() {
    // The targets are the job's: no lock.
    double sum = 0;
    for (const Target& target : job_.targets) sum += target.position.real();
    EXPECT_TRUE(std::isfinite(sum));
    const auto set = ThreeCorners();
    const MutexLock lock(&mutex_);
    if (job_.work == Work::kOpen) {
      EXPECT_TRUE(policy_.AdmitFrames(1e-3));
      policy_.Opened(
          {set, set->RestTargets()}, latest_, 1, [] { return Status(); },
          std::make_unique<app::WireAnswer>());
    } else {
      policy_.FrameTook(1e-3);
      policy_.Moved(std::make_unique<app::WireAnswer>());
    }
    Pump();
  }

  const Limits limits_{};
  const runtime::FakeClock clock_{};
  const bool latest_;
  const std::uint64_t updates_;

  Mutex mutex_;
  CondVar changed_;
  app::StreamPolicy policy_ ABSL_GUARDED_BY(mutex_){
      limits_,
      clock_,
      {[](double) { return Status(); }, [](double) { return Status(); }, [](double) {}}};
  bool opened_ ABSL_GUARDED_BY(mutex_) = false;
  std::uint64_t sent_ ABSL_GUARDED_BY(mutex_) = 0;
  std::uint64_t answered_ ABSL_GUARDED_BY(mutex_) = 0;
  bool finished_ ABSL_GUARDED_BY(mutex_) = false;
  app::StreamJob job_;  // the running job's
  runtime::WorkerPool wire_{2, 16};
  runtime::WorkerPool workers_{2, 16};
};

TEST(PolicyThreadsTest, ReadsWritesJobsAndSweepsSideBySide) {
  for (const bool latest : {kLatest, kEvery}) {
    constexpr std::uint64_t kUpdates = 2'000;
    BusyStream stream(latest, kUpdates);
    std::atomic<bool> over = false;
    BoundedThread sweeper("the sweeper", [&] {
      for (int i = 0; i < 20'000 && !over; ++i) stream.Sweep();
    });
    EXPECT_TRUE(stream.Wait()) << "the stream did not finish in time";
    over = true;
    sweeper.Join();
    stream.Stop();
    EXPECT_EQ(stream.answered(), kUpdates);
  }
}

}  // namespace
}  // namespace arap::testing
