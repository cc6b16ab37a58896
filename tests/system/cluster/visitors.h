// Visitors: clients whose sessions come, are asked and go. What was acknowledged has to be there.
#pragma once

#include <string>

#include "arap/client/client.h"
#include "tests/system/cluster/crowd.h"
#include "tests/system/cluster/drags.h"

namespace arap::cluster {

class Visitors : public Crowd {
 public:
  Visitors(const std::string& address, const Puppet& puppet, std::size_t count);
  ~Visitors() { Stop(); }

  // After Stop, which looks for all sessions that were not deleted.
  std::size_t calls() const { return calls_; }
  std::size_t acknowledged() const { return acknowledged_; }
  std::size_t lost() const { return lost_; }

 private:
  void Visit(std::size_t number);
  void Deform(const client::Session& session, std::size_t turn);

  const std::string address_;
  const Puppet& puppet_;
  const client::CallOptions call_{.timeout = kPatience, .retry_within = kRetryWithin};
  std::atomic<std::size_t> acknowledged_ = 0, lost_ = 0;
};

}  // namespace arap::cluster
