// Where in a mesh of the plane a point lies, in barycentric coordinates; and TriangleBoxes, which
// find the triangles near a point without looking at all of them, also in a mesh that changes its
// shape with every frame.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "arap/model/mesh.h"
#include "core/mesh/topology.h"

namespace arap {

struct Located {
  std::uint32_t triangle = kNone;
  std::array<double, 3> barycentric{};
  double distance = 0;  // how far snapping moved it
};

// Barycentric coordinates of `p`; finite for non-degenerate triangles, negative outside.
std::array<double, 3> Barycentric(const std::array<Complex, 3>& corners, Complex p);

// How far outside a triangle a point may be and still count, relative to the triangle.
inline constexpr double kLocateTolerance = 1e-9;

// Where in the triangle `p` lies, its boundary included up to `tolerance`; nothing when it does not.
// Triangles of either orientation hold points; degenerate ones do not.
std::optional<Located> LocateIn(std::span<const Complex> vertices,
                                std::span<const Triangle> triangles, std::uint32_t triangle,
                                Complex p, double tolerance = kLocateTolerance);

// The lowest triangle that holds `p`. O(#F), without tables: about 0.1 ms at 20k triangles; for many
// points of one shape see TriangleBoxes.
std::optional<Located> Locate(std::span<const Complex> vertices,
                              std::span<const Triangle> triangles, Complex p,
                              double tolerance = kLocateTolerance);

// The nearest point of the boundary to `p`. Needs at least one boundary edge.
Located NearestOnBoundary(std::span<const Complex> vertices, std::span<const Triangle> triangles,
                          const Topology& topology, Complex p);

// The box of a triangle or of several, a little larger than they are: by more than the tolerance
// that Locate has.
struct TriangleBox {
  double x0, y0, x1, y1;
  std::uint32_t lowest;  // triangle of it
  double highest;        // depth of a corner, 0 without depths

  bool Holds(Complex p) const {
    return p.real() >= x0 && p.real() <= x1 && p.imag() >= y0 && p.imag() <= y1;
  }
};

// Of one triangle. `depths` (#V) may be empty.
TriangleBox BoxOf(std::span<const Complex> vertices, std::span<const Triangle> triangles,
                  std::uint32_t triangle, std::span<const double> depths = {});

// All triangles, neighbours near one another: by their middles along a curve that fills the plane.
// O(#F log #F). Neighbours stay neighbours when the mesh is bent: it is enough to do this once.
std::vector<std::uint32_t> NearbyOrder(std::span<const Complex> vertices,
                                       std::span<const Triangle> triangles);

// The boxes of a shape, and of groups of them, and of groups of those. Immutable. Everything given
// must outlive it.
class TriangleBoxes {
 public:
  // `order` is NearbyOrder's, of any shape of these triangles. O(#F): about as much as looking at
  // every triangle once.
  TriangleBoxes(std::span<const std::uint32_t> order, std::span<const Complex> vertices,
                std::span<const Triangle> triangles, std::span<const double> depths = {});

  // Calls visit(triangle) for every triangle in groups that all of `wanted(box)` lets through, in no
  // order that means something. O(log #F) where few are wanted.
  template <class Wanted, class Visit>
  void ForEach(Wanted wanted, Visit visit) const {
    if (!levels_.empty()) Walk(levels_.size() - 1, 0, wanted, visit);
  }

 private:
  static constexpr std::size_t kGroup = 8;

  template <class Wanted, class Visit>
  void Walk(std::size_t level, std::size_t begin, Wanted& wanted, Visit& visit) const {
    const std::vector<TriangleBox>& boxes = levels_[level];
    for (std::size_t i = begin; i < boxes.size() && i < begin + kGroup; ++i) {
      if (!wanted(boxes[i])) continue;
      if (level > 0) {
        Walk(level - 1, i * kGroup, wanted, visit);
        continue;
      }
      for (std::size_t k = i * kGroup; k < order_.size() && k < (i + 1) * kGroup; ++k) {
        visit(order_[k]);
      }
    }
  }

  std::span<const std::uint32_t> order_;
  std::vector<std::vector<TriangleBox>> levels_;  // groups of triangles, groups of those, …
};

// The lowest triangles that hold points and vertices of one shape. Each of its two tables is made when
// it is first needed, in O(#F); then a vertex takes O(1), and a point O(log #F) where few triangles lie
// over one another. Not thread-safe. Everything given must outlive it.
class TriangleFinder {
 public:
  // `order` is NearbyOrder's, of any shape of these triangles.
  TriangleFinder(std::span<const std::uint32_t> order, std::span<const Complex> vertices,
                 std::span<const Triangle> triangles)
      : order_(order), vertices_(vertices), triangles_(triangles) {}

  // What Locate finds.
  std::optional<Located> At(Complex p, double tolerance = kLocateTolerance);
  // The lowest triangle that has the vertex, or kNone.
  std::uint32_t Of(std::uint32_t vertex);

  const TriangleBoxes& boxes();

 private:
  const std::span<const std::uint32_t> order_;
  const std::span<const Complex> vertices_;
  const std::span<const Triangle> triangles_;
  std::optional<TriangleBoxes> boxes_;
  std::vector<std::uint32_t> first_triangle_;  // #V
};

}  // namespace arap
