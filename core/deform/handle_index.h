// HandleIndex: finds the handles of a set by their ids.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "arap/model/handle.h"

namespace arap {

// A sorted order rather than a hash table: clients choose the ids, and must not be able to choose
// slow ones. Immutable.
class HandleIndex {
 public:
  HandleIndex() = default;

  // `handles` have different ids. O(n log n).
  explicit HandleIndex(std::span<const PlacedHandle> handles) : by_id_(handles.size()) {
    std::iota(by_id_.begin(), by_id_.end(), 0u);
    std::sort(by_id_.begin(), by_id_.end(), [&](std::uint32_t a, std::uint32_t b) {
      return handles[a].handle.id < handles[b].handle.id;
    });
  }

  // Where `id` is among `handles`, those that the index was made of. compare(a, b) says like
  // std::string_view::compare how two ids stand to each other; it is called at most
  // ⌊log2 n⌋ + 2 times.
  template <class Compare>
  std::optional<std::size_t> Find(std::span<const PlacedHandle> handles, std::string_view id,
                                  Compare compare) const {
    const auto at = std::partition_point(by_id_.begin(), by_id_.end(), [&](std::uint32_t i) {
      return compare(handles[i].handle.id, id) < 0;
    });
    if (at == by_id_.end() || compare(handles[*at].handle.id, id) != 0) return std::nullopt;
    return *at;
  }

  std::size_t bytes() const { return by_id_.size() * sizeof(std::uint32_t); }

 private:
  std::vector<std::uint32_t> by_id_;  // places in the set, in the order of their ids
};

}  // namespace arap
