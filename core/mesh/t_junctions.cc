#include "core/mesh/t_junctions.h"

#include <algorithm>
#include <array>
#include <numeric>

#include <Eigen/Geometry>

#include "core/base/try.h"
#include "core/mesh/space.h"

namespace arap {
namespace {

constexpr std::size_t kJunctionsPerSide = 4;
constexpr std::size_t kLooksPerSide = 2000;
constexpr std::size_t kLeaf = 8;  // places

// A stretch of a straight line.
struct Stretch {
  Eigen::Vector3d from, along;

  // Where along it the nearest point to `p` is, 0 to 1.
  double Nearest(const Eigen::Vector3d& p) const {
    const double length = along.squaredNorm();
    return length > 0 ? std::clamp(along.dot(p - from) / length, 0.0, 1.0) : 0.0;
  }
  double Distance(const Eigen::Vector3d& p) const { return (from + Nearest(p) * along - p).norm(); }

  // Whether it comes into a box.
  bool Meets(const Eigen::AlignedBox3d& box) const {
    double enter = 0, leave = 1;
    for (int k = 0; k < 3; ++k) {
      if (along[k] == 0) {
        if (from[k] < box.min()[k] || from[k] > box.max()[k]) return false;
        continue;
      }
      double a = (box.min()[k] - from[k]) / along[k], b = (box.max()[k] - from[k]) / along[k];
      if (a > b) std::swap(a, b);
      enter = std::max(enter, a);
      leave = std::min(leave, b);
    }
    return enter <= leave;
  }
};

// Vertices with equal coordinates, one such place after the other: triangles of a soup have all of
// theirs in common.
class Places {
 public:
  // `vertices` each once.
  Places(std::span<const Point3> points, std::vector<std::uint32_t> vertices)
      : vertices_(std::move(vertices)) {
    std::sort(vertices_.begin(), vertices_.end(), [&](std::uint32_t a, std::uint32_t b) {
      return points[a] != points[b] ? points[a] < points[b] : a < b;
    });
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
      if (i == 0 || points[vertices_[i]] != points[vertices_[i - 1]]) begin_.push_back(i);
      if (begin_.back() == i) points_.push_back(points[vertices_[i]]);
    }
    begin_.push_back(vertices_.size());
  }

  std::span<const Point3> points() const { return points_; }
  std::span<const std::uint32_t> At(std::size_t place) const {
    return std::span(vertices_).subspan(begin_[place], begin_[place + 1] - begin_[place]);
  }

 private:
  std::vector<std::uint32_t> vertices_;
  std::vector<std::size_t> begin_;
  std::vector<Point3> points_;
};

// Places in boxes, and those in boxes.
class PlaceTree {
 public:
  // Refers to the points.
  PlaceTree(std::span<const Point3> points, double margin)
      : points_(points), places_(points.size()), margin_(margin) {
    std::iota(places_.begin(), places_.end(), 0u);
    if (!places_.empty()) Build(0, places_.size());
  }

  // Calls visit(place) for all that may be within the margin of the segment, as long as look() lets it
  // look into another box.
  template <class Look, class Visit>
  void Near(const Stretch& segment, Look look, Visit visit) {
    if (!nodes_.empty()) open_.assign(1, 0);
    while (!open_.empty() && look()) {
      const Node& node = nodes_[open_.back()];
      open_.pop_back();
      if (!segment.Meets(node.box)) continue;
      if (node.second != kNone) {
        open_.push_back(node.second);
        open_.push_back(node.first);
        continue;
      }
      for (std::size_t i = node.begin; i < node.end; ++i) visit(places_[i]);
    }
    open_.clear();
  }

 private:
  struct Node {
    Eigen::AlignedBox3d box;  // larger by the margin
    std::size_t begin = 0, end = 0;
    std::uint32_t first = kNone, second = kNone;  // nodes; none in a leaf
  };

  std::uint32_t Build(std::size_t begin, std::size_t end) {
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    Node node;
    for (std::size_t i = begin; i < end; ++i) node.box.extend(Vec(points_[places_[i]]));
    const Eigen::Vector3d sizes = node.box.sizes();
    node.box.min().array() -= margin_;
    node.box.max().array() += margin_;
    node.begin = begin, node.end = end;
    nodes_.push_back(node);
    if (end - begin <= kLeaf) return index;
    Eigen::Index axis = 0;
    sizes.maxCoeff(&axis);
    const auto k = static_cast<std::size_t>(axis);
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [this](std::size_t i) {
      return places_.begin() + static_cast<std::ptrdiff_t>(i);
    };
    std::nth_element(at(begin), at(middle), at(end), [&](std::uint32_t a, std::uint32_t b) {
      return points_[a][k] != points_[b][k] ? points_[a][k] < points_[b][k] : a < b;
    });
    const std::uint32_t first = Build(begin, middle), second = Build(middle, end);
    nodes_[index].first = first;
    nodes_[index].second = second;
    return index;
  }

  std::span<const Point3> points_;
  std::vector<std::uint32_t> places_;
  double margin_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> open_;  // nodes to be looked into
};

class JunctionSearch {
 public:
  JunctionSearch(std::span<const Point3> points, std::span<const Triangle> triangles,
                 std::span<const Side> border, double tolerance)
      : points_(points),
        triangles_(triangles),
        border_(border),
        tolerance_(tolerance),
        looks_(kLooksPerSide * (border.size() + 1)) {
    for (std::uint32_t i = 0; i < border.size(); ++i) {
      ends_.push_back({border[i].v0, i});
      ends_.push_back({border[i].v1, i});
    }
    std::sort(ends_.begin(), ends_.end());
  }

  Result<TJunctions> Run(const CancelToken& cancel) {
    std::vector<std::uint32_t> vertices;
    for (const auto& [vertex, side] : ends_) {
      if (vertices.empty() || vertices.back() != vertex) vertices.push_back(vertex);
    }
    const Places places(points_, std::move(vertices));
    // A little more, for what is rounded.
    PlaceTree tree(places.points(), 1.1 * tolerance_);
    TJunctions junctions;
    for (std::size_t i = 0; i < border_.size(); ++i) {
      if (i % 1024 == 0) CHECK_OK(cancel.Check());
      const Stretch segment = StretchOf(border_[i]);
      if (segment.along.norm() <= 2 * tolerance_) continue;
      tree.Near(
          segment, [this] { return Look(); },
          [&](std::uint32_t place) {
            const Eigen::Vector3d p = Vec(places.points()[place]);
            if (!IsInside(p, border_[i], segment)) return;
            for (const std::uint32_t vertex : places.At(place)) {
              if (!RunsAlong(vertex, border_[i], segment)) continue;
              junctions.found.push_back({border_[i].index, segment.Nearest(p), vertex});
            }
          });
      if (looks_ == 0 || junctions.found.size() > kJunctionsPerSide * border_.size()) {
        junctions.cut_short = true;
        break;
      }
    }
    std::sort(junctions.found.begin(), junctions.found.end(),
              [](const TJunction& a, const TJunction& b) {
                if (a.side != b.side) return a.side < b.side;
                return a.at != b.at ? a.at < b.at : a.vertex < b.vertex;
              });
    return junctions;
  }

 private:
  Stretch StretchOf(const Side& side) const {
    return {Vec(points_[side.v0]), Vec(points_[side.v1]) - Vec(points_[side.v0])};
  }

  bool Look() {
    if (looks_ > 0) --looks_;
    return looks_ > 0;
  }

  // Whether it is on the side, and not at its ends.
  bool IsInside(const Eigen::Vector3d& p, const Side& side, const Stretch& segment) const {
    // Most are not even near its line, which costs no root or quotient to find out.
    const double far = 1.01 * tolerance_ * tolerance_ * segment.along.squaredNorm();
    if (segment.along.cross(p - segment.from).squaredNorm() > far) return false;
    return segment.Distance(p) <= tolerance_ && (p - Vec(points_[side.v0])).norm() > tolerance_ &&
           (p - Vec(points_[side.v1])).norm() > tolerance_;
  }

  // Whether a vertex of another triangle has an edge that lies along the side, or on which an end of
  // the side lies.
  bool RunsAlong(std::uint32_t vertex, const Side& side, const Stretch& segment) {
    const Triangle& own = triangles_[side.triangle()];
    if (vertex == own[0] || vertex == own[1] || vertex == own[2]) return false;
    for (auto at = std::lower_bound(ends_.begin(), ends_.end(), End{vertex, 0});
         at != ends_.end() && (*at)[0] == vertex && Look(); ++at) {
      const Side& edge = border_[(*at)[1]];
      if (edge.triangle() == side.triangle()) continue;
      const std::uint32_t other = edge.v0 == vertex ? edge.v1 : edge.v0;
      if (segment.Distance(Vec(points_[other])) <= tolerance_) return true;
      const Stretch along = StretchOf(edge);
      for (const std::uint32_t end : {side.v0, side.v1}) {
        const Eigen::Vector3d q = Vec(points_[end]);
        if (along.Distance(q) <= tolerance_) return true;
      }
    }
    return false;
  }

  using End = std::array<std::uint32_t, 2>;  // vertex, place in `border_`

  std::span<const Point3> points_;
  std::span<const Triangle> triangles_;
  std::span<const Side> border_;
  double tolerance_;
  std::size_t looks_;  // that are left
  std::vector<End> ends_;
};

}  // namespace

Result<TJunctions> FindTJunctions(std::span<const Point3> points,
                                  std::span<const Triangle> triangles, std::span<const Side> border,
                                  double tolerance, const CancelToken& cancel) {
  return JunctionSearch(points, triangles, border, tolerance).Run(cancel);
}

std::vector<Side> BorderSides(std::span<const Side> sides) {
  std::vector<Side> border;
  ForEachEdge(sides, [&](std::span<const Side> edge) {
    if (edge.size() == 1) border.push_back(edge[0]);
  });
  return border;
}

}  // namespace arap
