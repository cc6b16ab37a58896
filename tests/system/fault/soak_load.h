// SoakLoad: a mixed load of bounded rate, for as long as it lives.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/random.h"
#include "tests/system/fault/client.h"

namespace arap::fault {

// Calls of one kind.
struct LoadCount {
  const char* what = "";
  std::atomic<std::size_t> done = 0;
  std::atomic<std::size_t> wrong = 0;  // answered other than they should be
};

class SoakLoad {
 public:
  // Prepares its sessions; false in good() when that fails.
  explicit SoakLoad(const std::string& address);
  ~SoakLoad();  // stops
  SoakLoad(const SoakLoad&) = delete;
  SoakLoad& operator=(const SoakLoad&) = delete;

  void Stop();
  bool good() const { return good_; }
  const std::vector<std::unique_ptr<LoadCount>>& counts() const { return counts_; }

 private:
  // One turn: whether everything was answered as it should be.
  using Turn = std::function<bool(FaultClient& client, testing::Random& random)>;

  // Runs turns in a thread, one every `period` at most.
  void Add(const char* what, std::chrono::milliseconds period, Turn turn);
  bool Prepare();
  bool Drag(FaultClient& client, testing::Random& random, bool hang_up);
  // Waits, or stops: true when it is time to stop.
  bool StopWithin(std::chrono::milliseconds period);

  const std::string address_;
  bool good_ = false;
  std::mutex mutex_;
  std::condition_variable stopping_;
  bool stop_ = false;  // guarded by mutex_
  std::vector<std::unique_ptr<LoadCount>> counts_;
  std::vector<std::thread> threads_;
};

}  // namespace arap::fault
