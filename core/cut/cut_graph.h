// Cut graphs: edges that turn a piece into a disk when it is cut along them.
#pragma once

#include <cstdint>
#include <queue>
#include <utility>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "core/cut/cut_field.h"
#include "core/cut/pieces.h"
#include "core/mesh/topology.h"

namespace arap {

// Draws cut graphs by a tree of cheapest paths and a cotree of dearest crossings [Erickson and
// Whittlesey 2005]: all boundaries and handles are joined to one root by cheapest paths. A closed
// piece without handles is cut along a tree that reaches its farthest and most curved places.
class CutGraph {
 public:
  // Refers to both. O(#V + #F) memory for all pieces together.
  CutGraph(CutField& field, const CancelToken& cancel);

  // Returns the ends of the tree of a closed piece without handles, which are part of the cut for
  // their own sake; nothing for others. The piece must have been measured. O(F log F).
  Result<std::vector<std::uint32_t>> Draw(const Piece& piece);

 private:
  void ContractBoundaries(const Piece& piece);
  void Reach(std::uint32_t vertex, double distance, std::uint32_t side);
  Status Grow();
  void DrawHandles(const Piece& piece);
  Result<std::vector<std::uint32_t>> DrawTree(const Piece& piece);
  std::uint32_t DrawSecondEdge(std::uint32_t vertex, std::uint32_t back);
  void DrawPathToRoot(std::uint32_t vertex);
  bool InTree(std::uint32_t side) const;

  CutField& field_;
  const CancelToken& cancel_;
  std::vector<std::uint32_t> leader_;  // #V: the vertex itself, or the first of its boundary loop
  std::vector<double> distance_;       // #V, of leaders, to the root
  std::vector<std::uint32_t> parent_;  // #V, of leaders: the side through which it was reached
  UnionFind cotree_;                   // #F
  using Entry = std::pair<double, std::uint32_t>;  // distance, leader
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
};

}  // namespace arap
