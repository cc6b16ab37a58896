// CGAL is here and in quality_mesh.cc only: its templates take long to compile.
#include <bit>
#include <cstdint>

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Constrained_triangulation_plus_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polyline_simplification_2/Squared_distance_cost.h>
#include <CGAL/Polyline_simplification_2/Stop_above_cost_threshold.h>
#include <CGAL/Polyline_simplification_2/Vertex_base_2.h>
#include <CGAL/Polyline_simplification_2/simplify.h>

#include "core/outline/outline.h"

namespace arap {
namespace {

namespace simplification = CGAL::Polyline_simplification_2;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Faces = CGAL::Constrained_triangulation_face_base_2<Kernel>;
using Vertices = simplification::Vertex_base_2<Kernel>;
using Constrained = CGAL::Constrained_Delaunay_triangulation_2<
    Kernel, CGAL::Triangulation_data_structure_2<Vertices, Faces>, CGAL::Exact_predicates_tag>;
using Curves = CGAL::Constrained_triangulation_plus_2<Constrained>;

// The squared distance to what was given, and so little that no two points cost the same: among
// equals the library takes what it finds first, which depends on addresses.
struct DistanceCost {
  double little;

  template <class Iterator>
  auto operator()(const Curves& curves, Iterator vertex) const {
    auto cost = simplification::Squared_distance_cost()(curves, vertex);
    if (cost) *cost += little * Noise((*vertex)->point().x(), (*vertex)->point().y());
    return cost;
  }

  // From 0 to 1, by the coordinates.
  static double Noise(double x, double y) {
    const std::uint64_t mixed = (std::bit_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15U) ^
                                (std::bit_cast<std::uint64_t>(y) * 0xc2b2ae3d27d4eb4fU);
    return static_cast<double>((mixed ^ (mixed >> 29U)) * 0xbf58476d1ce4e5b9U >> 11U) * 0x1p-53;
  }
};

}  // namespace

Result<std::vector<Outline>> SimplifyOutlines(std::span<const Outline> outlines, double tolerance) {
  Curves curves;
  std::vector<Curves::Constraint_id> ids;
  std::vector<Kernel::Point_2> points;
  for (const Outline& outline : outlines) {
    points.clear();
    for (const Complex p : outline) points.emplace_back(p.real(), p.imag());
    ids.push_back(curves.insert_constraint(points.begin(), points.end(), /*close=*/true));
  }
  const double most = tolerance * tolerance;
  simplification::simplify(curves, DistanceCost{1e-9 * most},
                           simplification::Stop_above_cost_threshold(most));

  std::vector<Outline> simple;
  for (const Curves::Constraint_id id : ids) {
    Outline& outline = simple.emplace_back();
    for (auto v = curves.vertices_in_constraint_begin(id);
         v != curves.vertices_in_constraint_end(id); ++v) {
      outline.emplace_back((*v)->point().x(), (*v)->point().y());
    }
    outline.pop_back();  // the first once more
  }
  return simple;
}

}  // namespace arap
