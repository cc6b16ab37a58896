// Herd: many streams of one client that all behave badly in the same way.
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <memory>
#include <vector>

#include "tests/system/fault/client.h"

namespace arap::fault {

enum class Habit {
  kSilent,  // opens the call and says nothing
  kIdle,    // opens the stream, reads what comes, never ends
  kPush,    // opens the stream and sends updates without end, reading nothing
};

struct HerdOptions {
  Habit habit = Habit::kIdle;
  v1::Delivery delivery = v1::DELIVERY_LATEST;
};

// On session "s" and set "h" with the handle "a" (FaultClient::SetUp). Methods are for one thread.
class Herd {
 public:
  // `client` outlives the herd.
  Herd(FaultClient& client, HerdOptions options);
  ~Herd();  // ends
  Herd(const Herd&) = delete;
  Herd& operator=(const Herd&) = delete;

  // Starts `count` more streams and returns at once.
  void Open(std::size_t count);

  std::size_t opened() const;   // streams that the server has said "opened" on
  std::size_t updates() const;  // updates that went out
  // Streams that have ended, and how many of them with each code.
  std::size_t ended() const;
  std::size_t ended(grpc::StatusCode code) const;
  std::size_t size() const { return members_.size(); }

  // Cancels every stream and waits until all have ended: false when that takes too long.
  bool End(std::chrono::milliseconds timeout = std::chrono::seconds(30));

 private:
  class Member;
  struct Tally;

  FaultClient& client_;
  const HerdOptions options_;
  std::unique_ptr<Tally> tally_;
  std::vector<std::unique_ptr<Member>> members_;
};

}  // namespace arap::fault
