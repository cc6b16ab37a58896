// A tree of bounding boxes over line segments: who may cross whom.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "arap/model/mesh.h"

namespace arap {

struct Segment {
  Complex from, to;
};

struct Box {
  Complex low, high;
  static Box Of(const Segment& s);
  void Include(const Box& other);
  bool Meets(const Box& other) const {
    return low.real() <= other.high.real() && other.low.real() <= high.real() &&
           low.imag() <= other.high.imag() && other.low.imag() <= high.imag();
  }
};

// Immutable once built; any number of threads may ask. Built in O(n log n).
class SegmentTree {
 public:
  explicit SegmentTree(std::span<const Segment> segments);

  // Calls visit(other) for the segments of index above `index` whose boxes meet that of segment
  // `index`, in no order to rely on.
  template <class Visit>
  void VisitAfter(std::uint32_t index, Visit visit) const {
    if (nodes_.empty()) return;
    const Box& box = boxes_[index];
    std::uint32_t stack[64];  // halving keeps the tree far shallower than this
    std::size_t depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
      const std::uint32_t at = stack[--depth];
      const Node& node = nodes_[at];
      if (node.last <= index || !node.box.Meets(box)) continue;
      if (node.right != 0) {
        stack[depth++] = node.right;
        stack[depth++] = at + 1;
        continue;
      }
      for (std::uint32_t k = node.begin; k < node.end; ++k) {
        if (items_[k] > index && boxes_[items_[k]].Meets(box)) visit(items_[k]);
      }
    }
  }

 private:
  // Over items_[begin, end); the children of node i are i + 1 and `right`, none when right is 0.
  struct Node {
    Box box;
    std::uint32_t begin = 0, end = 0;
    std::uint32_t right = 0;
    std::uint32_t last = 0;  // the highest index in it
  };
  std::uint32_t Build(std::uint32_t begin, std::uint32_t end);

  std::vector<Box> boxes_;            // by segment
  std::vector<std::uint32_t> items_;  // segment indices, node by node
  std::vector<Node> nodes_;
};

}  // namespace arap
