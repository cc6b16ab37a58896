// Editors: several clients that edit and read the handle sets of the same sessions at once, and the
// history of each session.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "arap/client/client.h"
#include "tests/support/random.h"
#include "tests/system/cluster/crowd.h"
#include "tests/system/cluster/drags.h"
#include "tests/system/cluster/history.h"

namespace arap::cluster {

class Editors : public Crowd {
 public:
  // `sessions` with two sets each, of which every one has three editors. Makes the sessions before
  // it returns.
  Editors(const std::string& address, const Puppet& puppet, std::size_t sessions,
          std::uint64_t seed);
  ~Editors() { Stop(); }

  // After Stop: reads every set once more, and answers all calls by session.
  const std::vector<std::vector<Call>>& Histories();

 private:
  void Edit(std::size_t session, std::size_t editor, testing::Random random);
  // Adds a handle and removes one of `mine`, which are known to be there.
  void EditOnce(client::Session& session, std::size_t number, Call call,
                std::vector<std::string>& mine, std::uint32_t vertex);
  void Read(client::Session& session, std::size_t number, const std::string& set);
  void Note(std::size_t session, Call call);

  const std::string address_;
  const client::CallOptions call_{.timeout = kPatience, .retry_within = kRetryWithin};
  std::mutex histories_mutex_;
  std::vector<std::vector<Call>> histories_;  // guarded by it until Stop
};

// Whether the checker finds, in this history, an acknowledged write that nobody ever saw, and a
// read that answers what was there before an edit: how many were planted in copies of it, and found.
struct Planted {
  std::size_t planted = 0, found = 0;
};
Planted PlantLostWrites(const std::vector<Call>& history);
Planted PlantStaleReads(const std::vector<Call>& history);

}  // namespace arap::cluster
