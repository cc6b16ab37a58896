// CGAL is here, in quality_mesh.cc and in insert.h for the two only: its templates take long to
// compile.
#include <bit>
#include <cstdint>

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Constrained_triangulation_plus_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polyline_simplification_2/Squared_distance_cost.h>
#include <CGAL/Polyline_simplification_2/Vertex_base_2.h>
#include <CGAL/Polyline_simplification_2/simplify.h>
#include <CGAL/exceptions.h>

#include "core/base/try.h"
#include "core/outline/asked.h"
#include "core/outline/insert.h"
#include "core/outline/outline.h"

namespace arap {
namespace {

namespace simplification = CGAL::Polyline_simplification_2;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Faces = CGAL::Constrained_triangulation_face_base_2<Kernel>;
using Vertices = simplification::Vertex_base_2<Kernel>;
using Constrained = CGAL::Constrained_Delaunay_triangulation_2<
    Kernel, CGAL::Triangulation_data_structure_2<Vertices, Faces>,
    CGAL::No_constraint_intersection_requiring_constructions_tag>;
using Curves = CGAL::Constrained_triangulation_plus_2<Constrained>;

// To take a vertex away costs the square of the edges at it: one with more stays.
constexpr std::size_t kMostEdges = 2000;

bool HasMoreEdges(const Curves& curves, Curves::Vertex_handle vertex, std::size_t most) {
  auto next = curves.incident_vertices(vertex);
  const auto first = next;
  std::size_t count = 0;
  do {
    if (++count > most) return true;
  } while (++next != first);
  return false;
}

// The squared distance to what was given, and so little that no two points cost the same: among
// equals the library takes what it finds first, which depends on addresses.
struct DistanceCost {
  double little;

  template <class Iterator>
  auto operator()(const Curves& curves, Iterator vertex) const {
    auto cost = simplification::Squared_distance_cost()(curves, vertex);
    if (!cost) return cost;
    if (HasMoreEdges(curves, *vertex, kMostEdges)) return decltype(cost)();
    *cost += little * Noise((*vertex)->point().x(), (*vertex)->point().y());
    return cost;
  }

  // From 0 to 1, by the coordinates.
  static double Noise(double x, double y) {
    const std::uint64_t mixed = (std::bit_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15U) ^
                                (std::bit_cast<std::uint64_t>(y) * 0xc2b2ae3d27d4eb4fU);
    return static_cast<double>((mixed ^ (mixed >> 29U)) * 0xbf58476d1ce4e5b9U >> 11U) * 0x1p-53;
  }
};

// Asked before each vertex that is taken away; the library copies it.
struct StopAbove {
  double most;
  Watch* watch;
  Status* stopped;

  template <class Cost>
  bool operator()(const Curves& curves, Curves::Vertex_handle vertex, const Cost& cost, std::size_t,
                  std::size_t) const {
    if (cost > most) return true;
    *stopped = watch->Check();
    // Those that were taken away left it their edges. What is done so far is right.
    return !*stopped || HasMoreEdges(curves, vertex, 2 * kMostEdges);
  }
};

Result<std::vector<Outline>> Simplify(std::span<const Outline> outlines, double tolerance,
                                      Watch& watch) {
  Curves curves;
  // First as edges alone, which can be interrupted and finds what crosses and touches.
  CHECK_OK(InsertOutlines(outlines, 0, watch, static_cast<Constrained&>(curves)));
  std::vector<Curves::Constraint_id> ids;
  std::vector<Kernel::Point_2> points;
  for (const Outline& outline : outlines) {
    points.clear();
    for (const Complex p : outline) points.emplace_back(p.real(), p.imag());
    ids.push_back(curves.insert_constraint(points.begin(), points.end(), /*close=*/true));
  }
  const double most = tolerance * tolerance;
  Status stopped;
  simplification::simplify(curves, DistanceCost{1e-9 * most}, StopAbove{most, &watch, &stopped});
  CHECK_OK(stopped);

  std::vector<Outline> simple;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    Outline& outline = simple.emplace_back();
    if (ids[i] == nullptr) {  // a point, given several times
      outline = outlines[i];
      continue;
    }
    for (auto v = curves.vertices_in_constraint_begin(ids[i]);
         v != curves.vertices_in_constraint_end(ids[i]); ++v) {
      outline.emplace_back((*v)->point().x(), (*v)->point().y());
    }
    outline.pop_back();  // the first once more
  }
  return simple;
}

}  // namespace

Result<std::vector<Outline>> SimplifyOutlines(std::span<const Outline> outlines, double tolerance,
                                              const CancelToken& cancel) {
  Watch watch(cancel, 5 + 20 * kSecondsToSimplify * static_cast<double>(PointsOf(outlines)));
  try {
    return Simplify(outlines, tolerance, watch);
  } catch (const CGAL::Failure_exception&) {
    return Fail(Fault(FaultKind::kInvalidOption,
                      "Outlines this close to one another, or this small for how far they are from "
                      "0, cannot be simplified.")
                    .Field("outlines"));
  }
}

}  // namespace arap
