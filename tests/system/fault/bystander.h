// Bystander: a well-behaved client that drags all the while, to see whether the others disturb it.
#pragma once

#include <atomic>
#include <string>
#include <thread>

#include "tests/system/fault/client.h"

namespace arap::fault {

// A thread with a connection, a session "bystander" and one stream; it sends an update, reads the
// shape, and so on. Any answer other than a shape is a failure of the test.
class Bystander {
 public:
  explicit Bystander(const std::string& address);
  ~Bystander();  // stops
  Bystander(const Bystander&) = delete;
  Bystander& operator=(const Bystander&) = delete;

  // Waits until `count` more frames have been answered: false when that takes longer than 20 s.
  bool GoesOn(std::size_t count = 20) const;

  // Ends the stream; its status must be OK. Harmless when repeated.
  void Stop();

  std::size_t frames() const { return frames_; }
  // The longest time that one frame took so far.
  std::chrono::milliseconds slowest() const { return std::chrono::milliseconds(slowest_); }

 private:
  void Run();

  FaultClient client_;
  std::atomic<bool> stop_ = false;
  std::atomic<std::size_t> frames_ = 0;
  std::atomic<long> slowest_ = 0;
  std::thread thread_;
};

}  // namespace arap::fault
