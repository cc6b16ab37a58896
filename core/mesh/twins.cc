#include "core/mesh/twins.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/mesh/space.h"
#include "core/mesh/topology.h"

namespace arap {
namespace {

// Cells are this many tolerances wide: most places are then near no other cell, and vertices that stand
// for themselves do not crowd in one.
constexpr double kCellWidth = 4;

using Steps = std::array<int, 3>;  // from a cell to another one, each -1, 0 or 1

// Cells counted along the axes from 1, in a single number: many times faster to sort.
class PackedCells {
 public:
  using Cell = std::uint64_t;

  // Whether there are few enough of them.
  static bool Fit(const Eigen::Vector3d& size, double width) {
    return width > 0 && size.maxCoeff() / width < static_cast<double>(kMask) - 2;
  }
  PackedCells(const Eigen::Vector3d& low, double width) : low_(low), width_(width) {}

  Cell Of(const Point3& p) const {
    Cell cell = 0;
    for (int k = 0; k < 3; ++k) {
      const double count = std::floor((p[static_cast<std::size_t>(k)] - low_[k]) / width_);
      cell |= (static_cast<Cell>(count) + 1) << (kBits * k);
    }
    return cell;
  }
  // How far the place is from the lower end of its cell.
  double Inside(const Point3& p, Cell cell, int k) const {
    const Cell count = ((cell >> (kBits * k)) & kMask) - 1;
    return p[static_cast<std::size_t>(k)] - low_[k] - static_cast<double>(count) * width_;
  }
  static Cell Next(Cell cell, const Steps& steps) {
    for (int k = 0; k < 3; ++k) {
      cell += static_cast<Cell>(static_cast<std::int64_t>(steps[static_cast<std::size_t>(k)]))
              << (kBits * k);
    }
    return cell;
  }

 private:
  static constexpr int kBits = 21;
  static constexpr Cell kMask = (Cell{1} << kBits) - 1;

  Eigen::Vector3d low_;
  double width_;
};

// Cells of any number; the places themselves with a width of 0.
class WideCells {
 public:
  using Cell = std::array<double, 3>;

  WideCells(const Eigen::Vector3d& low, double width) : low_(low), width_(width) {}

  Cell Of(const Point3& p) const {
    Cell cell;
    for (std::size_t k = 0; k < 3; ++k) {
      // -0 is 0.
      cell[k] = width_ > 0 ? std::floor((p[k] - low_[static_cast<int>(k)]) / width_) : p[k] + 0.0;
    }
    return cell;
  }
  double Inside(const Point3& p, const Cell& cell, int axis) const {
    const auto k = static_cast<std::size_t>(axis);
    return p[k] - low_[axis] - cell[k] * width_;
  }
  static Cell Next(const Cell& cell, const Steps& steps) {
    return {cell[0] + steps[0], cell[1] + steps[1], cell[2] + steps[2]};
  }

 private:
  Eigen::Vector3d low_;
  double width_;
};

template <class Cells>
class TwinFinder {
 public:
  TwinFinder(std::span<const Point3> points, std::span<const std::uint32_t> ids, double tolerance,
             const Eigen::Vector3d& low)
      : points_(points),
        ids_(ids),
        tolerance_(tolerance),
        width_(kCellWidth * tolerance),
        grid_(low, width_) {
    order_.resize(ids.size());
    std::vector<Entry> entries(ids.size());
    for (std::uint32_t i = 0; i < ids.size(); ++i) entries[i] = {grid_.Of(points[ids[i]]), i};
    std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
      return a.cell != b.cell ? a.cell < b.cell : a.index < b.index;
    });
    for (const Entry& entry : entries) {
      if (cells_.empty() || cells_.back() != entry.cell) cells_.push_back(entry.cell);
      order_[entry.index] = static_cast<std::uint32_t>(cells_.size() - 1);
    }
    first_.assign(cells_.size(), kNone);
    next_.assign(ids.size(), kNone);
  }

  std::vector<std::uint32_t> Run() {
    std::vector<std::uint32_t> twins(ids_.size());
    for (std::uint32_t i = 0; i < ids_.size(); ++i) {
      const std::uint32_t found = Lowest(i);
      twins[i] = ids_[found == kNone ? i : found];
      if (found != kNone) continue;
      next_[i] = first_[order_[i]];
      first_[order_[i]] = i;
    }
    return twins;
  }

 private:
  using Cell = typename Cells::Cell;
  struct Entry {
    Cell cell;
    std::uint32_t index;
  };

  // The lowest that stands for itself within the tolerance.
  std::uint32_t Lowest(std::uint32_t i) const {
    const Point3& p = points_[ids_[i]];
    std::uint32_t lowest = kNone;
    LookInto(order_[i], p, lowest);
    if (tolerance_ == 0) return lowest;
    // Cells that the ball about the place reaches into, as far as they are others.
    const Cell& own = cells_[order_[i]];
    Steps from{}, to{};
    for (std::size_t k = 0; k < 3; ++k) {
      const double inside = grid_.Inside(p, own, static_cast<int>(k));
      // A little more, for what is rounded.
      from[k] = inside <= 1.01 * tolerance_ ? -1 : 0;
      to[k] = width_ - inside <= 1.01 * tolerance_ ? 1 : 0;
    }
    for (int x = from[0]; x <= to[0]; ++x) {
      for (int y = from[1]; y <= to[1]; ++y) {
        for (int z = from[2]; z <= to[2]; ++z) {
          if (x == 0 && y == 0 && z == 0) continue;
          const Cell cell = Cells::Next(own, {x, y, z});
          const auto at = std::lower_bound(cells_.begin(), cells_.end(), cell);
          if (at == cells_.end() || *at != cell) continue;
          LookInto(static_cast<std::size_t>(at - cells_.begin()), p, lowest);
        }
      }
    }
    return lowest;
  }

  void LookInto(std::size_t cell, const Point3& p, std::uint32_t& lowest) const {
    for (std::uint32_t i = first_[cell]; i != kNone; i = next_[i]) {
      const bool near = tolerance_ == 0 ||
                        (Vec(points_[ids_[i]]) - Vec(p)).squaredNorm() <= tolerance_ * tolerance_;
      if (near) lowest = std::min(lowest, i);
    }
  }

  std::span<const Point3> points_;
  std::span<const std::uint32_t> ids_;
  double tolerance_, width_;
  Cells grid_;
  std::vector<Cell> cells_;           // those that hold something, ascending
  std::vector<std::uint32_t> order_;  // of each id, its cell
  // Lists of those that stand for themselves, a list per cell.
  std::vector<std::uint32_t> first_, next_;
};

}  // namespace

std::vector<std::uint32_t> FirstTwins(std::span<const Point3> points,
                                      std::span<const std::uint32_t> ids, double tolerance) {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e308), high = -low;
  for (const std::uint32_t v : ids) {
    low = low.cwiseMin(Vec(points[v]));
    high = high.cwiseMax(Vec(points[v]));
  }
  const double width = kCellWidth * tolerance;
  // What lies in a plane along the axes is then in the middle of its cells, far from others.
  low.array() -= width / 2;
  if (PackedCells::Fit(high - low, width)) {
    return TwinFinder<PackedCells>(points, ids, tolerance, low).Run();
  }
  return TwinFinder<WideCells>(points, ids, tolerance, low).Run();
}

}  // namespace arap
