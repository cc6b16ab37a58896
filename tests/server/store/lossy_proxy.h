// LossyProxy: a connection to Redis that breaks when it is told to.
#pragma once

#include <atomic>
#include <optional>
#include <string>

#include "tests/support/bounded.h"

namespace arap::testing {

// Listens on a free port of this machine and passes everything on, one connection at a time.
class LossyProxy {
 public:
  explicit LossyProxy(int redis_port);
  ~LossyProxy();
  LossyProxy(const LossyProxy&) = delete;
  LossyProxy& operator=(const LossyProxy&) = delete;

  std::string Url() const;
  // Redis gets what is sent next and does it; its answer is dropped, and with it the connection.
  void LoseNextAnswer() { lose_ = true; }
  int lost() const { return lost_; }

 private:
  void Serve();
  void Pass(int client);

  const int redis_port_;
  int listener_ = -1;
  int port_ = 0;
  std::atomic<bool> stop_{false};
  std::atomic<bool> lose_{false};
  std::atomic<int> lost_{0};
  std::optional<BoundedThread> thread_;  // last: it uses the others
};

}  // namespace arap::testing
