// Crowd: clients on threads of their own that go on until they are stopped, and what went wrong.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "arap/base/result.h"
#include "arap/client/call.h"

namespace arap::cluster {

// How long a client goes on asking before it counts as failed: generous, because correctness must
// not depend on how busy the machine is.
inline constexpr std::chrono::seconds kPatience{60};
inline constexpr std::chrono::seconds kRetryWithin{45};

class Crowd {
 public:
  Crowd() = default;
  Crowd(const Crowd&) = delete;
  Crowd& operator=(const Crowd&) = delete;

  // Everybody ends what is under way, and is waited for. What derives from this stops in its
  // destructor, before its members go.
  void Stop();

  // What users saw and should not have, in sentences; the first hundred of them.
  std::vector<std::string> Complaints() const;
  std::size_t complaint_count() const { return complaint_count_; }

 protected:
  ~Crowd() = default;

  void Join(std::function<void()> client) { threads_.emplace_back(std::move(client)); }
  // True when it is time to stop, which is waited for.
  bool StopWithin(std::chrono::milliseconds period);
  void Complain(const std::string& sentence);
  // Whether a call that may not fail was answered.
  template <class Answer>
  bool Answered(const std::string& what, const Answer& answer) {
    ++calls_;
    if (answer) return true;
    Complain(what + ": " + answer.error().message);
    return false;
  }

  std::atomic<std::size_t> calls_ = 0;

 private:
  mutable std::mutex mutex_;
  std::condition_variable stopping_;
  bool stop_ = false;                    // guarded by mutex_
  std::vector<std::string> complaints_;  // likewise
  std::atomic<std::size_t> complaint_count_ = 0;
  std::vector<std::thread> threads_;
};

}  // namespace arap::cluster
