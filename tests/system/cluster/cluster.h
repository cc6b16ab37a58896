// Cluster: several arapd behind haproxy over one Redis, as script/cluster starts them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tests/system/fault/server_process.h"

namespace arap::cluster {

// For the thread that has started it: the cluster ends with that.
class Cluster {
 public:
  // Starts nothing. `flags` are of every arapd, beside those that tests need.
  explicit Cluster(std::size_t servers, std::vector<std::string> flags = {});

  // False with a failure of the test when it is not ready within two minutes.
  bool Start();

  // `script/cluster VERB MEMBER`; what it says. A failure of the test when it ends with another
  // exit code than 0.
  std::string Do(const std::string& verb, const std::string& member = {});

  // For clients: the balancer.
  const std::string& address() const { return address_; }
  // What a member has written: "1", "redis", "haproxy".
  std::string Log(const std::string& member) const;

 private:
  std::vector<std::string> Words() const;

  const std::size_t servers_;
  const std::vector<std::string> flags_;
  fault::TempFolder folder_;
  fault::ChildProcess process_;
  std::string address_;
};

}  // namespace arap::cluster
