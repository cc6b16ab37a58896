// Adding columns of Z to a shape: the part of a frame that grows with the handles.
#pragma once

#include <cstddef>

#include "arap/model/mesh.h"
#include "core/energy/shape_view.h"

namespace arap {

// How many columns are added in one pass over the shape.
inline constexpr std::size_t kColumnGroup = 4;

// One column (#V) and what it is multiplied with.
struct ScaledColumn {
  const double* values = nullptr;
  Complex factor;
};

// shape += Σ values·factor over `columns` (any number), for vertices [begin, end). The order of
// the columns decides the rounding.
void AddColumns(const ScaledColumn* columns, std::size_t count, std::size_t begin, std::size_t end,
                ShapeView shape);

// The same for columns that `column_at(i)` makes, over all n vertices; block by block, so that the
// shape stays in the nearest cache.
template <class ColumnAt>
void AddColumns(std::size_t count, std::size_t n, ShapeView shape, ColumnAt column_at) {
  constexpr std::size_t kBlock = 1024;
  for (std::size_t begin = 0; begin < n; begin += kBlock) {
    const std::size_t end = begin + kBlock < n ? begin + kBlock : n;
    for (std::size_t i = 0; i < count; i += kColumnGroup) {
      ScaledColumn group[kColumnGroup];
      const std::size_t size = count - i < kColumnGroup ? count - i : kColumnGroup;
      for (std::size_t k = 0; k < size; ++k) group[k] = column_at(i + k);
      AddColumns(group, size, begin, end, shape);
    }
  }
}

}  // namespace arap
