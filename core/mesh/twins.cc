#include "core/mesh/twins.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/mesh/space.h"
#include "core/mesh/topology.h"

namespace arap {
namespace {

// Cells are this many tolerances wide: most places are then near no other cell, and vertices that stand
// for themselves do not crowd in one.
constexpr double kCellWidth = 4;

// Counted in cells along the axes; the place itself when equal places alone are one.
using Cell = std::array<double, 3>;

class TwinFinder {
 public:
  TwinFinder(std::span<const Point3> points, std::span<const std::uint32_t> ids, double tolerance)
      : points_(points), ids_(ids), tolerance_(tolerance), width_(kCellWidth * tolerance) {
    for (const std::uint32_t v : ids) low_ = low_.cwiseMin(Vec(points[v]));
    order_.resize(ids.size());
    std::vector<Entry> entries(ids.size());
    for (std::uint32_t i = 0; i < ids.size(); ++i) entries[i] = {CellOf(points[ids[i]]), i};
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
  struct Entry {
    Cell cell;
    std::uint32_t index;
  };

  Cell CellOf(const Point3& p) const {
    Cell cell;
    for (std::size_t k = 0; k < 3; ++k) {
      // -0 is 0.
      cell[k] =
          tolerance_ > 0 ? std::floor((p[k] - low_[static_cast<int>(k)]) / width_) : p[k] + 0.0;
    }
    return cell;
  }

  // The lowest that stands for itself within the tolerance.
  std::uint32_t Lowest(std::uint32_t i) const {
    const Point3& p = points_[ids_[i]];
    std::uint32_t lowest = kNone;
    LookInto(order_[i], p, lowest);
    if (tolerance_ == 0) return lowest;
    // Cells that the ball about the place reaches into, as far as they are others.
    const Cell& own = cells_[order_[i]];
    std::array<int, 3> from{}, to{};
    for (std::size_t k = 0; k < 3; ++k) {
      const double inside = p[k] - low_[static_cast<int>(k)] - own[k] * width_;
      // A little more, for what is rounded.
      from[k] = inside <= 1.01 * tolerance_ ? -1 : 0;
      to[k] = width_ - inside <= 1.01 * tolerance_ ? 1 : 0;
    }
    for (int x = from[0]; x <= to[0]; ++x) {
      for (int y = from[1]; y <= to[1]; ++y) {
        for (int z = from[2]; z <= to[2]; ++z) {
          if (x == 0 && y == 0 && z == 0) continue;
          const Cell cell{own[0] + x, own[1] + y, own[2] + z};
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
  Eigen::Vector3d low_ = Eigen::Vector3d::Constant(1e308);
  std::vector<Cell> cells_;           // those that hold something, ascending
  std::vector<std::uint32_t> order_;  // of each id, its cell
  // Lists of those that stand for themselves, a list per cell.
  std::vector<std::uint32_t> first_, next_;
};

}  // namespace

std::vector<std::uint32_t> FirstTwins(std::span<const Point3> points,
                                      std::span<const std::uint32_t> ids, double tolerance) {
  return TwinFinder(points, ids, tolerance).Run();
}

}  // namespace arap
