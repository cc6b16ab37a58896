// Bystander: another owner who works as anybody would while a server is attacked, and keeps notes.
#pragma once

#include <atomic>
#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "core/base/mutex.h"
#include "tests/attack/verdict.h"
#include "tests/support/bounded.h"
#include "tests/system/fault/client.h"

namespace arap::attack {

// Drags at 30 updates a second, a new stream every second; compiles every 200 ms and flattens every
// 200 ms; looks at /readyz and at a new connection twice a second. A thread each.
class Bystander {
 public:
  // Sets up a session; good() says whether that went well.
  Bystander(const std::string& address, const std::string& admin, const std::string& token);
  ~Bystander();  // stops
  Bystander(const Bystander&) = delete;
  Bystander& operator=(const Bystander&) = delete;

  bool good() const { return good_; }
  // What was seen since it was asked the last time; a call that still runs counts with the time
  // that it has taken up to now.
  Seen Take();

 private:
  using Clock = std::chrono::steady_clock;
  enum Kind : std::size_t { kFrame, kCompile, kFlatten, kKinds };

  // Notes the beginning and the end of something. Nothing is noted after Stop.
  void Begin(Kind kind);
  void End(Kind kind, const char* what, const grpc::Status& status);
  // Waits until `time`, or for Stop: false then.
  bool Until(Clock::time_point time) const;

  bool SetUp();
  void Drag();
  bool DragOnce(Clock::time_point end);
  void Compile();
  void Flatten();
  void Look();

  const std::string address_, admin_;
  fault::FaultClient client_;
  v1::FlattenRequest surface_;
  bool good_ = false;
  std::atomic<bool> stop_ = false;
  Mutex mutex_;
  Seen seen_ ABSL_GUARDED_BY(mutex_);
  std::optional<Clock::time_point> since_[kKinds] ABSL_GUARDED_BY(mutex_);
  std::vector<testing::BoundedThread> threads_;
};

}  // namespace arap::attack
