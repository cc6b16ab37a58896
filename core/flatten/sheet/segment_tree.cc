#include "core/flatten/sheet/segment_tree.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace arap {
namespace {

constexpr std::uint32_t kLeafSize = 4;

}  // namespace

Box Box::Of(const Segment& s) {
  return {{std::min(s.from.real(), s.to.real()), std::min(s.from.imag(), s.to.imag())},
          {std::max(s.from.real(), s.to.real()), std::max(s.from.imag(), s.to.imag())}};
}

void Box::Include(const Box& other) {
  low = {std::min(low.real(), other.low.real()), std::min(low.imag(), other.low.imag())};
  high = {std::max(high.real(), other.high.real()), std::max(high.imag(), other.high.imag())};
}

SegmentTree::SegmentTree(std::span<const Segment> segments) : items_(segments.size()) {
  boxes_.reserve(segments.size());
  for (const Segment& s : segments) boxes_.push_back(Box::Of(s));
  std::iota(items_.begin(), items_.end(), 0u);
  if (!items_.empty()) Build(0, static_cast<std::uint32_t>(items_.size()));
}

std::uint32_t SegmentTree::Build(std::uint32_t begin, std::uint32_t end) {
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  Node node{boxes_[items_[begin]], begin, end, 0, 0};
  for (std::uint32_t k = begin; k < end; ++k) {
    node.box.Include(boxes_[items_[k]]);
    node.last = std::max(node.last, items_[k]);
  }
  nodes_.push_back(node);
  if (end - begin <= kLeafSize) return index;
  const Complex extent = node.box.high - node.box.low;
  const bool wide = extent.real() >= extent.imag();
  // Twice the centre along the longer side; the index decides between equals.
  const auto key = [&](std::uint32_t s) {
    const Complex sum = boxes_[s].low + boxes_[s].high;
    return std::make_pair(wide ? sum.real() : sum.imag(), s);
  };
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(items_.begin() + begin, items_.begin() + middle, items_.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  Build(begin, middle);
  const std::uint32_t right = Build(middle, end);
  nodes_[index].right = right;
  return index;
}

}  // namespace arap
