#include "core/mesh/locate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/plane.h"

namespace arap {
namespace {

TriangleBox Empty() {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  return {kInfinity, kInfinity, -kInfinity, -kInfinity, kNone, -kInfinity};
}

void Add(const TriangleBox& part, TriangleBox& whole) {
  whole.x0 = std::min(whole.x0, part.x0), whole.x1 = std::max(whole.x1, part.x1);
  whole.y0 = std::min(whole.y0, part.y0), whole.y1 = std::max(whole.y1, part.y1);
  whole.lowest = std::min(whole.lowest, part.lowest);
  whole.highest = std::max(whole.highest, part.highest);
}

// 16 bits of x and of y by turns.
std::uint32_t Interleaved(std::uint32_t x, std::uint32_t y) {
  const auto spread = [](std::uint32_t n) {
    n = (n | (n << 8u)) & 0x00ff00ffu;
    n = (n | (n << 4u)) & 0x0f0f0f0fu;
    n = (n | (n << 2u)) & 0x33333333u;
    return (n | (n << 1u)) & 0x55555555u;
  };
  return spread(x) | (spread(y) << 1u);
}

}  // namespace

std::array<double, 3> Barycentric(const std::array<Complex, 3>& c, Complex p) {
  const double area = TwiceArea(c[0], c[1], c[2]);
  const double b1 = TwiceArea(c[0], p, c[2]) / area;
  const double b2 = TwiceArea(c[0], c[1], p) / area;
  return {1 - b1 - b2, b1, b2};
}

std::optional<Located> LocateIn(std::span<const Complex> vertices,
                                std::span<const Triangle> triangles, std::uint32_t triangle,
                                Complex p, double tolerance) {
  const Triangle& t = triangles[triangle];
  auto b = Barycentric({vertices[t[0]], vertices[t[1]], vertices[t[2]]}, p);
  // A NaN from a degenerate triangle fails these comparisons.
  if (!(b[0] >= -tolerance && b[1] >= -tolerance && b[2] >= -tolerance)) return std::nullopt;
  double sum = 0;
  for (double& x : b) sum += x = std::max(x, 0.0);
  for (double& x : b) x /= sum;
  return Located{triangle, b, 0};
}

std::optional<Located> Locate(std::span<const Complex> vertices,
                              std::span<const Triangle> triangles, Complex p, double tolerance) {
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    if (auto found = LocateIn(vertices, triangles, t, p, tolerance)) return found;
  }
  return std::nullopt;
}

Located NearestOnBoundary(std::span<const Complex> vertices, std::span<const Triangle> triangles,
                          const Topology& topology, Complex p) {
  Located best;
  best.distance = std::numeric_limits<double>::infinity();
  for (const Edge& edge : topology.edges) {
    if (!edge.boundary()) continue;
    const Complex a = vertices[edge.v0], d = vertices[edge.v1] - a;
    const double s = std::clamp(std::real(std::conj(d) * (p - a)) / std::norm(d), 0.0, 1.0);
    const double distance = std::abs(a + s * d - p);
    if (distance >= best.distance) continue;
    best = {edge.triangle[0], {}, distance};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = triangles[edge.triangle[0]][k];
      best.barycentric[k] = v == edge.v0 ? 1 - s : v == edge.v1 ? s : 0;
    }
  }
  return best;
}

TriangleBox BoxOf(std::span<const Complex> vertices, std::span<const Triangle> triangles,
                  std::uint32_t triangle, std::span<const double> depths) {
  TriangleBox box = Empty();
  for (const std::uint32_t v : triangles[triangle]) {
    const Complex p = vertices[v];
    Add({p.real(), p.imag(), p.real(), p.imag(), triangle, depths.empty() ? 0 : depths[v]}, box);
  }
  // Coordinates are rounded, and a weight may be a little below 0.
  const auto grow = [](double& low, double& high) {
    constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
    const double by = 4 * kLocateTolerance * (high - low) +
                      8 * kEpsilon * std::max(std::abs(low), std::abs(high));
    low -= by, high += by;
  };
  grow(box.x0, box.x1);
  grow(box.y0, box.y1);
  return box;
}

std::vector<std::uint32_t> NearbyOrder(std::span<const Complex> vertices,
                                       std::span<const Triangle> triangles) {
  TriangleBox all = Empty();
  for (std::uint32_t t = 0; t < triangles.size(); ++t) Add(BoxOf(vertices, triangles, t), all);
  constexpr double kSteps = 65535;
  const double size = std::max(all.x1 - all.x0, all.y1 - all.y0);
  const auto step = [&](double x, double from) {
    const double at = (x - from) / size * kSteps;
    return static_cast<std::uint32_t>(at > 0 && at < kSteps ? at : 0);
  };
  std::vector<std::pair<std::uint32_t, std::uint32_t>> keyed;
  keyed.reserve(triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const TriangleBox box = BoxOf(vertices, triangles, t);
    keyed.emplace_back(Interleaved(step(0.5 * box.x0 + 0.5 * box.x1, all.x0),
                                   step(0.5 * box.y0 + 0.5 * box.y1, all.y0)),
                       t);
  }
  std::sort(keyed.begin(), keyed.end());
  std::vector<std::uint32_t> order;
  order.reserve(keyed.size());
  for (const auto& [key, triangle] : keyed) order.push_back(triangle);
  return order;
}

TriangleBoxes::TriangleBoxes(std::span<const std::uint32_t> order,
                             std::span<const Complex> vertices, std::span<const Triangle> triangles,
                             std::span<const double> depths)
    : order_(order) {
  std::vector<TriangleBox> boxes((order.size() + kGroup - 1) / kGroup, Empty());
  for (std::size_t k = 0; k < order.size(); ++k) {
    Add(BoxOf(vertices, triangles, order[k], depths), boxes[k / kGroup]);
  }
  while (!boxes.empty()) {
    const std::vector<TriangleBox>& last = levels_.emplace_back(std::move(boxes));
    if (last.size() <= kGroup) break;
    boxes.assign((last.size() + kGroup - 1) / kGroup, Empty());
    for (std::size_t i = 0; i < last.size(); ++i) Add(last[i], boxes[i / kGroup]);
  }
}

const TriangleBoxes& TriangleFinder::boxes() {
  if (!boxes_) boxes_.emplace(order_, vertices_, triangles_);
  return *boxes_;
}

std::optional<Located> TriangleFinder::At(Complex p, double tolerance) {
  std::optional<Located> lowest;
  const auto wanted = [&](const TriangleBox& box) {
    if (lowest && box.lowest > lowest->triangle) return false;
    // A point with a weight of -tolerance is outside by as much of the triangle.
    const double dx = 4 * tolerance * (box.x1 - box.x0), dy = 4 * tolerance * (box.y1 - box.y0);
    return p.real() >= box.x0 - dx && p.real() <= box.x1 + dx && p.imag() >= box.y0 - dy &&
           p.imag() <= box.y1 + dy;
  };
  boxes().ForEach(wanted, [&](std::uint32_t t) {
    if (lowest && lowest->triangle < t) return;
    if (const auto found = LocateIn(vertices_, triangles_, t, p, tolerance)) lowest = found;
  });
  return lowest;
}

std::uint32_t TriangleFinder::Of(std::uint32_t vertex) {
  if (first_triangle_.empty()) {
    first_triangle_.assign(vertices_.size(), kNone);
    for (auto t = static_cast<std::uint32_t>(triangles_.size()); t-- > 0;) {
      for (const std::uint32_t v : triangles_[t]) first_triangle_[v] = t;
    }
  }
  return first_triangle_[vertex];
}

}  // namespace arap
