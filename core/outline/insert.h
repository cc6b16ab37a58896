// Outlines as edges of a triangulation of CGAL's, and when to give up on them. For quality_mesh.cc and
// simplify.cc only: CGAL's templates take long to compile.
#pragma once

#include <cstddef>
#include <numeric>
#include <span>
#include <unordered_map>
#include <vector>

#include <CGAL/Spatial_sort_traits_adapter_2.h>
#include <CGAL/property_map.h>
#include <CGAL/spatial_sort.h>
#include <fmt/format.h>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/model/outline.h"
#include "core/base/cpu_timer.h"
#include "core/base/try.h"

namespace arap {

// Whether to go on.
class Watch {
 public:
  // `most_seconds` of processor time of this thread.
  Watch(const CancelToken& cancel, double most_seconds)
      : cancel_(cancel), most_seconds_(most_seconds) {}

  // To be asked at every small step. The faults of `cancel`, and kLimitExceeded.
  Status Check() {
    constexpr std::size_t kSteps = 64;
    if (++steps_ % kSteps != 0) return {};
    CHECK_OK(cancel_.Check());
    seconds_ += 1e-3 * timer_.Lap();
    if (seconds_ <= most_seconds_) return {};
    return Fail(FaultKind::kLimitExceeded,
                "The outlines are wound into one another so often that working on them takes more "
                "than twenty times what so many points take otherwise.");
  }

 private:
  const CancelToken& cancel_;
  const double most_seconds_;
  CpuTimer timer_;
  double seconds_ = 0;
  std::size_t steps_ = 0;
};

// Inserts the points, and the outlines as edges that stay. kInvalidOption when they are no borders of
// a region, because they cross or touch. `origin` is where their 0 is, for the sentence.
template <class Delaunay>
Status InsertOutlines(std::span<const Outline> outlines, Complex origin, Watch& watch,
                      Delaunay& delaunay) {
  using Vertex = typename Delaunay::Vertex_handle;
  using Point = typename Delaunay::Point;

  // The vertices of all points, outline by outline; inserted so that each is near the one before.
  std::vector<Point> points;
  for (const Outline& outline : outlines) {
    for (const Complex p : outline) points.emplace_back(p.real(), p.imag());
  }
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto places = CGAL::make_property_map(points);
  CGAL::spatial_sort(
      order.begin(), order.end(),
      CGAL::Spatial_sort_traits_adapter_2<typename Delaunay::Geom_traits, decltype(places)>(
          places));
  std::vector<Vertex> vertices(points.size());
  typename Delaunay::Face_handle near;
  for (const std::size_t i : order) {
    CHECK_OK(watch.Check());
    vertices[i] = delaunay.insert(points[i], near);
    near = vertices[i]->face();
  }

  std::size_t begin = 0;
  try {
    for (const Outline& outline : outlines) {
      Vertex before = vertices[begin + outline.size() - 1];
      for (std::size_t i = begin; i < begin + outline.size(); ++i) {
        CHECK_OK(watch.Check());
        if (vertices[i] != before) delaunay.insert_constraint(before, vertices[i]);
        before = vertices[i];
      }
      begin += outline.size();
    }
  } catch (const typename Delaunay::Intersection_of_constraints_exception&) {
    return Fail(FaultKind::kInvalidOption, "The outlines cross one another or themselves.");
  }

  // Each vertex has two lines, and each line was given once.
  std::unordered_map<Vertex, int> lines;
  std::size_t count = 0;
  for (auto edge = delaunay.finite_edges_begin(); edge != delaunay.finite_edges_end(); ++edge) {
    if (!delaunay.is_constrained(*edge)) continue;
    ++count;
    ++lines[edge->first->vertex(Delaunay::cw(edge->second))];
    ++lines[edge->first->vertex(Delaunay::ccw(edge->second))];
  }
  begin = 0;
  for (const Outline& outline : outlines) {
    for (std::size_t i = begin; i < begin + outline.size(); ++i) {
      const std::size_t next = i + 1 == begin + outline.size() ? begin : i + 1;
      if (vertices[i] == vertices[next]) continue;
      if (lines[vertices[i]] == 2 && count-- > 0) continue;
      const Complex p = origin + outline[i - begin];
      return Fail(FaultKind::kInvalidOption,
                  fmt::format("The outlines touch one another or themselves at ({:g}, {:g}).",
                              p.real(), p.imag()));
    }
    begin += outline.size();
  }
  return {};
}

}  // namespace arap
