#include "core/flatten/given.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/mesh/topology.h"
#include "core/mesh/validation.h"

namespace arap {
namespace {

// max(s1, 1/|s2|), above everything for what is flipped.
double Badness(const std::array<double, 2>& values) {
  const double worst = std::max(values[0], 1 / std::max(std::abs(values[1]), 1e-300));
  return values[1] < 0 ? 1e300 + worst : worst;
}

class Translator {
 public:
  Translator(const Repair& repair, Flattening& flat) : repair_(repair), flat_(flat) {}

  void Run() {
    FindChartsOfVertices();
    corners_.resize(repair_.given.size());
    charts_.resize(repair_.given.size());
    values_.resize(repair_.given.size());
    std::vector<std::uint32_t> torn, left_out;
    for (const std::uint32_t t : flat_.degenerate) left_out.push_back(repair_.TriangleOf(t));
    for (std::uint32_t t = 0; t < repair_.given.size(); ++t) {
      const Repair::Parts parts = repair_.PartsOf(t);
      if (parts.size() == 0) {
        corners_[t] = repair_.CornersOf(t);
        charts_[t] = chart_of_[corners_[t][0]];
        left_out.push_back(t);
      } else if (TakeParts(t, parts)) {
        torn.push_back(t);
      }
    }
    std::sort(left_out.begin(), left_out.end());
    left_out.erase(std::unique(left_out.begin(), left_out.end()), left_out.end());
    flat_.degenerate = std::move(left_out);
    flat_.corner_uv = std::move(corners_);
    flat_.triangle_chart = std::move(charts_);
    flat_.singular_values = std::move(values_);
    CountTriangles();
    PlaceWelded();
    AddWarning("torn_triangles", torn,
               fmt::format("{} triangles that were split are cut apart inside; their corners have "
                           "positions of one side of the cut",
                           torn.size()),
               flat_.warnings);
  }

 private:
  // Of the vertices that stand for themselves; those of nothing that is left are put on the first.
  void FindChartsOfVertices() {
    chart_of_.assign(repair_.vertex.size(), 0);
    for (std::size_t t = flat_.corner_uv.size(); t-- > 0;) {
      for (const std::uint32_t u : flat_.corner_uv[t]) {
        if (u < chart_of_.size()) chart_of_[u] = flat_.triangle_chart[t];
      }
    }
  }

  // Whether the parts do not agree about where a corner is.
  bool TakeParts(std::uint32_t t, Repair::Parts parts) {
    const Triangle wanted = repair_.CornersOf(t);
    bool torn = false;
    Triangle& corners = corners_[t];
    corners = {kNone, kNone, kNone};
    charts_[t] = flat_.triangle_chart[parts.begin];
    values_[t] = flat_.singular_values[parts.begin];
    for (std::uint32_t part = parts.begin; part < parts.end; ++part) {
      for (const std::uint32_t u : flat_.corner_uv[part]) {
        for (std::size_t k = 0; k < 3; ++k) {
          if (flat_.source[u] != wanted[k]) continue;
          if (corners[k] == kNone) corners[k] = u;
          torn = torn || corners[k] != u;
        }
      }
      torn = torn || flat_.triangle_chart[part] != charts_[t];
      if (Badness(flat_.singular_values[part]) > Badness(values_[t])) {
        values_[t] = flat_.singular_values[part];
      }
    }
    return torn;
  }

  void CountTriangles() {
    for (FlatChart& chart : flat_.charts) {
      chart.triangles = 0;
      chart.distortion.worst_triangle = repair_.TriangleOf(chart.distortion.worst_triangle);
    }
    flat_.distortion.worst_triangle = repair_.TriangleOf(flat_.distortion.worst_triangle);
    for (const std::uint32_t c : flat_.triangle_chart) ++flat_.charts[c].triangles;
  }

  void PlaceWelded() {
    bool welded = false;
    for (std::size_t t = repair_.given.size(); t-- > 0;) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t v = repair_.given[t][k], u = flat_.corner_uv[t][k];
        if (repair_.vertex[v] == v) continue;
        flat_.uv[v] = flat_.uv[u];
        flat_.first_step[v] = flat_.first_step[u];
        welded = true;
      }
    }
    if (welded) flat_.welded = repair_.vertex;
  }

  const Repair& repair_;
  Flattening& flat_;
  std::vector<std::uint32_t> chart_of_;
  std::vector<std::array<std::uint32_t, 3>> corners_;
  std::vector<std::uint32_t> charts_;
  std::vector<std::array<double, 2>> values_;
};

}  // namespace

FlattenOptions OfMended(FlattenOptions options, const Repair& repair) {
  options.energy = repair.OfMended(std::move(options.energy));
  for (UvPin& pin : options.pins) pin.vertex = repair.VertexOf(pin.vertex);
  for (GrainLine& line : options.grain_lines) {
    line.from = repair.VertexOf(line.from);
    line.to = repair.VertexOf(line.to);
  }
  return options;
}

void OfGiven(const Repair& repair, Flattening& flat) { Translator(repair, flat).Run(); }

}  // namespace arap
