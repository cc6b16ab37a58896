// CGAL is here, in simplify.cc and in insert.h for the two only: its templates take long to compile.
#include "core/outline/quality_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_mesh_face_base_2.h>
#include <CGAL/Delaunay_mesh_size_criteria_2.h>
#include <CGAL/Delaunay_mesh_vertex_base_2.h>
#include <CGAL/Delaunay_mesher_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/exceptions.h>
#include <fmt/format.h>

#include "core/base/plane.h"
#include "core/base/try.h"
#include "core/outline/asked.h"
#include "core/outline/insert.h"
#include "core/outline/smooth.h"

namespace arap {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Faces = CGAL::Delaunay_mesh_face_base_2<Kernel>;
using Vertices = CGAL::Delaunay_mesh_vertex_base_2<Kernel>;
using Delaunay = CGAL::Constrained_Delaunay_triangulation_2<
    Kernel, CGAL::Triangulation_data_structure_2<Vertices, Faces>,
    CGAL::No_constraint_intersection_requiring_constructions_tag>;
using Criteria = CGAL::Delaunay_mesh_size_criteria_2<Delaunay>;
using Mesher = CGAL::Delaunay_mesher_2<Delaunay, Criteria>;
using Point = Kernel::Point_2;

// sin² of the smallest angle that refinement always reaches between wide corners: 20.7 degrees.
constexpr double kShape = 0.125;

Complex ToComplex(const Point& p) { return {p.x(), p.y()}; }
Point ToPoint(Complex p) { return {p.real(), p.imag()}; }

double TwiceAreaOf(Delaunay::Face_handle face) {
  return TwiceArea(ToComplex(face->vertex(0)->point()), ToComplex(face->vertex(1)->point()),
                   ToComplex(face->vertex(2)->point()));
}

// A region inside: a point of it, far from its border as triangles of the outline go.
struct Region {
  Point seed;
  double area = 0;
};

// What lies within an odd number of outlines, piece by piece.
std::vector<Region> RegionsOf(const Delaunay& delaunay) {
  std::vector<Region> regions;
  std::unordered_map<Delaunay::Face_handle, bool> inside;
  std::vector<std::pair<Delaunay::Face_handle, bool>> borders{{delaunay.infinite_face(), false}};
  std::vector<Delaunay::Face_handle> waiting;
  while (!borders.empty()) {
    const auto [first, is_inside] = borders.back();
    borders.pop_back();
    if (!inside.emplace(first, is_inside).second) continue;
    Region region;
    double largest = -1;
    waiting.push_back(first);
    while (!waiting.empty()) {
      const Delaunay::Face_handle face = waiting.back();
      waiting.pop_back();
      if (is_inside) {
        const double area = TwiceAreaOf(face) / 2;
        region.area += area;
        if (area > largest) {
          largest = area;
          region.seed = CGAL::centroid(delaunay.triangle(face));
        }
      }
      for (int k = 0; k < 3; ++k) {
        const Delaunay::Face_handle next = face->neighbor(k);
        if (face->is_constrained(k)) {
          borders.emplace_back(next, !is_inside);
        } else if (inside.emplace(next, is_inside).second) {
          waiting.push_back(next);
        }
      }
    }
    if (is_inside) regions.push_back(region);
  }
  return regions;
}

std::vector<Point> SeedsOf(const std::vector<Region>& regions) {
  std::vector<Point> seeds;
  for (const Region& region : regions) seeds.push_back(region.seed);
  return seeds;
}

// A mesh, and what of it is outline.
struct Draft {
  PlanarMesh mesh;
  std::vector<bool> on_outline;                             // #V
  std::vector<std::array<std::uint32_t, 2>> outline_edges;  // as they lie in triangles
};

// What is inside, its vertices from below and from the left.
Draft Extract(const Delaunay& delaunay) {
  std::vector<Delaunay::Vertex_handle> vertices;
  std::unordered_map<Delaunay::Vertex_handle, std::uint32_t> number;
  for (auto face = delaunay.finite_faces_begin(); face != delaunay.finite_faces_end(); ++face) {
    if (!face->is_in_domain()) continue;
    for (int k = 0; k < 3; ++k) {
      if (number.emplace(face->vertex(k), 0).second) vertices.push_back(face->vertex(k));
    }
  }
  std::sort(vertices.begin(), vertices.end(), [](const auto& a, const auto& b) {
    return std::pair(a->point().y(), a->point().x()) < std::pair(b->point().y(), b->point().x());
  });
  Draft draft;
  for (const auto& vertex : vertices) {
    number[vertex] = static_cast<std::uint32_t>(draft.mesh.vertices.size());
    draft.mesh.vertices.push_back(ToComplex(vertex->point()));
  }
  draft.on_outline.assign(vertices.size(), false);
  for (auto face = delaunay.finite_faces_begin(); face != delaunay.finite_faces_end(); ++face) {
    if (!face->is_in_domain()) continue;
    Triangle t;
    for (std::size_t k = 0; k < 3; ++k) t[k] = number[face->vertex(static_cast<int>(k))];
    for (std::size_t k = 0; k < 3; ++k) {
      if (!face->is_constrained(static_cast<int>(k))) continue;
      const std::array edge{t[(k + 1) % 3], t[(k + 2) % 3]};
      draft.outline_edges.push_back(edge);
      for (const std::uint32_t v : edge) draft.on_outline[v] = true;
    }
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    draft.mesh.triangles.push_back(t);
  }
  std::sort(draft.mesh.triangles.begin(), draft.mesh.triangles.end());
  std::sort(draft.outline_edges.begin(), draft.outline_edges.end());
  return draft;
}

// Triangles without narrow angles whose edges are at most `edge` long.
Result<Draft> Refine(Delaunay delaunay, const std::vector<Point>& seeds, double edge,
                     std::size_t most, Watch& watch) {
  Mesher mesher(delaunay, Criteria(kShape, edge));
  mesher.set_seeds(seeds.begin(), seeds.end(), /*mark=*/true);
  mesher.init();
  while (!mesher.is_refinement_done() && mesher.try_one_step_refine_mesh()) {
    CHECK_OK(watch.Check());
    if (delaunay.number_of_vertices() > most) {
      return Fail(Fault(FaultKind::kLimitExceeded,
                        fmt::format("Triangles without narrow angles would need more than {} "
                                    "vertices here: the outlines come too close to one another.",
                                    most))
                      .Detail("limit", most));
    }
  }
  return Extract(delaunay);
}

// The draft with as many vertices as were asked for, if the outlines let it.
Result<Draft> RefineTo(std::size_t wanted, const Delaunay& outlines,
                       const std::vector<Region>& regions, std::size_t most, Watch& watch) {
  const std::vector<Point> seeds = SeedsOf(regions);
  double area = 0;
  for (const Region& region : regions) area += region.area;
  // A vertex takes two equilateral triangles; they come out smaller than the bound by about a half.
  const auto asked = static_cast<double>(wanted);
  double edge = 1.5 * std::sqrt(2 * area / (std::sqrt(3.0) * asked));

  constexpr int kTries = 5;
  constexpr double kNearEnough = 0.05;
  Draft best;
  double best_miss = 0;
  bool refused = false;
  for (int i = 0; i < kTries; ++i) {
    auto draft = Refine(outlines, seeds, edge, most, watch);
    if (!draft) {
      // More were asked for than there may be, or narrow places need them whatever the bound.
      const bool too_many = !DetailOf(draft.error(), "limit").empty();
      if (too_many && !best.mesh.vertices.empty()) break;
      if (!too_many || refused) return draft;
      refused = true;
      edge *= 2;
      continue;
    }
    const double ratio = static_cast<double>(draft->mesh.vertices.size()) / asked;
    const double miss = std::abs(std::log(ratio));
    if (best.mesh.vertices.empty() || miss < best_miss) {
      best = *std::move(draft);
      best_miss = miss;
    } else if (ratio > 1) {
      break;  // the outline alone needs them
    }
    if (miss < kNearEnough) break;
    edge *= std::clamp(std::sqrt(ratio), 0.25, 4.0);
  }
  return best;
}

// The Delaunay triangles of the same vertices.
Draft Retriangulate(const Draft& draft, const std::vector<Point>& seeds) {
  Delaunay delaunay;
  std::vector<Delaunay::Vertex_handle> handles;
  Delaunay::Face_handle near;
  for (const Complex p : draft.mesh.vertices) {
    handles.push_back(delaunay.insert(ToPoint(p), near));
    near = handles.back()->face();
  }
  for (const auto& [a, b] : draft.outline_edges) {
    delaunay.insert_constraint(handles[a], handles[b]);
  }
  Mesher::mark_facets(delaunay, seeds.begin(), seeds.end(), /*mark=*/true);
  return Extract(delaunay);
}

// To nine digits of the largest coordinate, so that files are short and say what is in memory.
void Round(PlanarMesh& mesh) {
  double largest = 0;
  for (const Complex p : mesh.vertices) {
    largest = std::max({largest, std::abs(p.real()), std::abs(p.imag())});
  }
  const int digits = 8 - static_cast<int>(std::floor(std::log10(largest)));
  const double units = std::pow(10.0, digits);
  const auto rounded = [units](double x) { return std::round(x * units) / units + 0.0; };
  if (!std::isfinite(units) || units == 0) return;
  for (Complex& p : mesh.vertices) p = {rounded(p.real()), rounded(p.imag())};
}

Result<QualityMesh> Finish(Draft draft, Complex origin, std::size_t pieces) {
  QualityMesh result{std::move(draft.mesh), pieces, 0, 180};
  Round(result.mesh);
  for (Complex& p : result.mesh.vertices) p += origin;
  for (const Triangle& t : result.mesh.triangles) {
    const auto corner = [&](std::size_t k) { return result.mesh.vertices[t[k]]; };
    result.smallest_angle =
        std::min(result.smallest_angle, SmallestAngle(corner(0), corner(1), corner(2)));
  }
  if (!(result.smallest_angle > 0)) {
    return Fail(
        Fault(FaultKind::kInvalidOption, "Outlines this close to one another cannot be meshed.")
            .Field("outlines"));
  }
  // Euler: vertices − edges + triangles = pieces − holes.
  const std::size_t edges = (3 * result.mesh.triangles.size() + draft.outline_edges.size()) / 2;
  result.holes = pieces + edges - result.mesh.vertices.size() - result.mesh.triangles.size();
  return result;
}

// MeshOutlines for outlines that were checked and are counted from `origin`. CGAL may throw.
Result<QualityMesh> Mesh(std::span<const Outline> outlines, Complex origin, std::size_t vertices,
                         std::size_t most, const CancelToken& cancel) {
  constexpr std::size_t kMostForEach = 100;
  const std::size_t points = PointsOf(outlines);
  most = std::min({most, kMaxMeshVertices, kMostForEach * (vertices + points)});
  // What is drawn against us may take quadratic time.
  Watch watch(cancel, 5 + 20 * EstimateMeshing(points, vertices, most).seconds);

  Delaunay delaunay;
  CHECK_OK(InsertOutlines(outlines, origin, watch, delaunay));
  const std::vector<Region> regions =
      delaunay.dimension() < 2 ? std::vector<Region>() : RegionsOf(delaunay);
  if (regions.empty()) return Fail(FaultKind::kEmptyMesh, "The outlines have nothing inside.");

  TRY(Draft draft, RefineTo(vertices, delaunay, regions, most, watch));
  constexpr int kSmoothings = 4;
  for (int i = 0; i < kSmoothings; ++i) {
    CHECK_OK(cancel.Check());
    Smooth(draft.on_outline, draft.mesh);
    draft = Retriangulate(draft, SeedsOf(regions));
  }
  return Finish(std::move(draft), origin, regions.size());
}

}  // namespace

Result<QualityMesh> MeshOutlines(std::span<const Outline> outlines, std::size_t vertices,
                                 std::size_t most, const CancelToken& cancel) {
  CHECK_OK(CheckAsked(outlines, vertices));
  // Where places are so close to one another that rounding moves points across edges, what CGAL
  // relies on does not hold. It checks that in every build (CGAL_DEBUG in core/CMakeLists.txt).
  try {
    const Complex origin = OriginOf(outlines);
    if (origin == Complex(0)) return Mesh(outlines, origin, vertices, most, cancel);
    return Mesh(CountedFrom(origin, outlines), origin, vertices, most, cancel);
  } catch (const CGAL::Failure_exception&) {
    return Fail(Fault(FaultKind::kInvalidOption,
                      "Outlines this close to one another, or this small for how far they are from "
                      "0, cannot be meshed.")
                    .Field("outlines"));
  }
}

}  // namespace arap
