// ReplayLog: what has to be said again on a new stream, so that it goes on where a lost one ended.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "arap/v1/deformation_service.pb.h"

namespace arap::client::internal {

// Of an update or an edit.
std::uint64_t SequenceOf(const v1::StreamDeformRequest& request);

// Not thread-safe. A stream's state on the server is its targets and what its edits have made of
// the handle set; a handle that is added starts where the shape of that moment has it. So the edits
// that were answered are kept, with the last targets before each; the targets after them, merged;
// and what was not answered, as it was sent. Memory: a target per handle and edit, and every update
// that has no answer, with `latest` about kMostPending of them.
class ReplayLog {
 public:
  // From so many on, updates of a LATEST stream that newer ones replace anyway become one.
  static constexpr std::size_t kMostPending = 256;

  explicit ReplayLog(bool latest) : latest_(latest) {}

  // An update or an edit goes out. False, and it is not kept, when its sequence has not grown: its
  // answer could not be told from others.
  bool Sent(const v1::StreamDeformRequest& request);
  // The answer to `sequence` came: a shape, or an error, which means that nothing was changed.
  // False when it was answered before.
  bool Answered(std::uint64_t sequence, bool good);

  // What to send behind the opening of a new stream, in this order; sequences grow.
  std::vector<v1::StreamDeformRequest> Messages() const;

 private:
  // Targets that several updates have come to: single ones, then all positions at once, which leave
  // angles and scales as they are, then single ones again. Each with the last sequence that it has
  // something from.
  struct Pose {
    std::map<std::string, v1::HandleTarget> before;
    std::vector<double> positions;
    std::map<std::string, v1::HandleTarget> after;
    std::uint64_t before_sequence = 0, positions_sequence = 0, after_sequence = 0;

    void Add(const v1::HandleUpdate& update);
    void Say(std::vector<v1::StreamDeformRequest>& out) const;
  };
  struct Edited {
    Pose before;
    v1::StreamDeformRequest edit;
  };

  void Keep(v1::StreamDeformRequest&& request);
  void Fold();

  const bool latest_;
  std::vector<Edited> edits_;
  Pose pose_;  // since the last edit
  std::deque<v1::StreamDeformRequest> pending_;
  std::optional<std::uint64_t> sent_;      // the last sequence
  std::optional<std::uint64_t> answered_;  // the last sequence
};

}  // namespace arap::client::internal
