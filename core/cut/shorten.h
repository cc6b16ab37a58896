// Shortening a cut graph without changing what it does.
#pragma once

#include <cstdint>
#include <queue>
#include <span>
#include <utility>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "core/cut/cut_field.h"
#include "core/cut/pieces.h"

namespace arap {

// Takes the stretches of a cut graph one by one. The disk with one stretch sewn up again is a ring
// that the stretch crosses; any other way across the ring does as well, and the cheapest is taken.
// What then hangs loose is sewn up too.
class CutShortener {
 public:
  // Refers to both. O(#V + #F) memory for all pieces together.
  CutShortener(CutField& field, const CancelToken& cancel);

  // `piece` is cut to a disk by what is drawn; `ends` are vertices that the cut must go on
  // reaching. Stops when little is gained any more, or when the work has come to a small multiple
  // of the size of the piece.
  Status Shorten(const Piece& piece, std::span<const std::uint32_t> ends);

 private:
  using Stretch = std::vector<std::uint32_t>;  // sides, each starts where the one before ends
  enum Shore : unsigned char { kNowhere, kNear, kFar };

  bool Node(std::uint32_t vertex) const;
  // Neither on the rim nor on what is drawn.
  bool Free(std::uint32_t vertex) const;
  Stretch StretchThrough(std::uint32_t side) const;
  std::uint32_t Onward(std::uint32_t side) const;
  Result<double> Improve(Stretch& stretch);
  std::vector<std::uint32_t> ShoreAt(std::uint32_t leaving);
  Result<Stretch> CheapestCrossing(std::uint32_t leaving, std::uint32_t arriving, double limit);
  void Try(std::uint32_t side, double distance, std::uint32_t goal);
  Shore ShoreBehind(std::uint32_t side) const;
  void Prune(std::uint32_t vertex);

  CutField& field_;
  const CancelToken& cancel_;
  std::vector<bool> is_end_;            // #V
  std::vector<bool> tried_;             // 3·#F, the lower sides of edges, in this sweep
  std::vector<unsigned char> shore_;    // 3·#F, of open sides during a search
  std::vector<double> distance_;        // #V, of free vertices during a search
  std::vector<std::uint32_t> parent_;   // #V, the side that reached them
  std::vector<std::uint32_t> touched_;  // the vertices to forget afterwards
  using Entry = std::pair<double, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
  double best_ = 0;  // of the crossings found so far
  std::uint32_t best_side_ = 0;
  std::size_t work_ = 0;
};

}  // namespace arap
