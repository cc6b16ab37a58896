#include "core/mesh/repair.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/base/try.h"
#include "core/mesh/defects.h"
#include "core/mesh/space.h"
#include "core/mesh/t_junctions.h"
#include "core/mesh/validation.h"

namespace arap {
namespace {

class Mender {
 public:
  Mender(std::span<const Point3> points, std::vector<Triangle>& triangles,
         const RepairOptions& options, const MeshLimits& limits, const CancelToken& cancel)
      : points_(points),
        triangles_(triangles),
        options_(options),
        limits_(limits),
        cancel_(cancel),
        nearness_(NearnessOf(points, triangles, options)) {}

  Result<Repair> Run() {
    // What is too large to be measured is refused by whoever measures it.
    if (!std::isfinite(nearness_.diagonal)) return std::move(repair_);
    CHECK_OK(CheckTolerance());
    if (!options_.any()) {
      sides_ = SortedSides(points_.size(), triangles_);
      TRY(repair_.warnings, FindDefects(points_, triangles_, sides_, options_, nearness_, cancel_));
      return std::move(repair_);
    }
    const std::vector<Triangle> given = triangles_;
    repair_.triangle.resize(given.size());
    std::iota(repair_.triangle.begin(), repair_.triangle.end(), 0u);
    if (options_.weld) WeldAll();
    CHECK_OK(cancel_.Check());
    if (options_.drop_duplicates) DropDuplicates();
    CHECK_OK(cancel_.Check());
    sides_ = SortedSides(points_.size(), triangles_);
    if (options_.stitch) {
      TRY(const bool split, StitchAll(sides_));
      if (split) sides_ = SortedSides(points_.size(), triangles_);
    }
    if (triangles_ != given) {
      repair_.given = given;
      if (repair_.vertex.empty()) {
        repair_.vertex.resize(points_.size());
        std::iota(repair_.vertex.begin(), repair_.vertex.end(), 0u);
      }
      std::sort(repair_.dropped.begin(), repair_.dropped.end());
    } else {
      repair_.vertex = {};
      repair_.triangle = {};
    }
    TRY(const auto defects, FindDefects(points_, triangles_, sides_, options_,
                                        NearnessOf(points_, triangles_, options_), cancel_));
    for (const Warning& defect : defects) repair_.warnings.push_back(repair_.OfGiven(defect));
    return std::move(repair_);
  }

  // Of the mended triangles, after Run; none where nothing was looked at.
  std::vector<Side> TakeSides() { return std::move(sides_); }

 private:
  Status CheckTolerance() const {
    if (!options_.tolerance || *options_.tolerance <= kMaxRepairTolerance * nearness_.diagonal)
      return {};
    return Fail(Fault(FaultKind::kInvalidOption,
                      fmt::format("A repair tolerance of {:g} is more than {:g} of the size of the "
                                  "mesh, {:g}.",
                                  *options_.tolerance, kMaxRepairTolerance, nearness_.diagonal))
                    .Field("repair.tolerance")
                    .Detail("value", *options_.tolerance)
                    .Detail("limit", kMaxRepairTolerance * nearness_.diagonal));
  }

  // Keeps the triangles for which keep(i) holds.
  template <class Keep>
  void KeepOnly(Keep keep) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      if (!keep(i)) continue;
      triangles_[kept] = triangles_[i];
      repair_.triangle[kept++] = repair_.triangle[i];
    }
    triangles_.resize(kept);
    repair_.triangle.resize(kept);
  }

  void WeldAll() {
    repair_.vertex = WeldedVertices(points_, triangles_, nearness_.places);
    std::vector<std::uint32_t> welded, collapsed;
    for (std::uint32_t v = 0; v < repair_.vertex.size(); ++v) {
      if (repair_.vertex[v] != v) welded.push_back(v);
    }
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      for (std::uint32_t& v : triangles_[t]) v = repair_.vertex[v];
      if (!Collapsed(triangles_[t])) continue;
      collapsed.push_back(t);
      repair_.dropped.push_back({t, kNone});
    }
    KeepOnly([this](std::size_t i) { return !Collapsed(triangles_[i]); });
    AddWarning("welded_vertices", welded,
               fmt::format("{} vertices were welded with others within {:.3g}", welded.size(),
                           nearness_.places),
               repair_.warnings);
    AddWarning(
        "collapsed_triangles", collapsed,
        fmt::format("{} triangles were smaller than the tolerance of welding, {:.3g}, and are "
                    "left out",
                    collapsed.size(), nearness_.places),
        repair_.warnings);
  }

  void DropDuplicates() {
    Duplicates duplicates = FindDuplicates(triangles_);
    if (duplicates.pairs.empty()) return;
    std::vector<bool> dropped(triangles_.size(), false);
    for (auto& [triangle, first] : duplicates.pairs) {
      dropped[triangle] = true;
      triangle = repair_.triangle[triangle];
      repair_.dropped.push_back({triangle, repair_.triangle[first]});
    }
    KeepOnly([&dropped](std::size_t i) { return !dropped[i]; });
    AddWarning("dropped_triangles", duplicates.triangles(),
               fmt::format("{} triangles had the same corners as others and are left out; {}",
                           duplicates.pairs.size(), duplicates.WhichWay()),
               repair_.warnings);
  }

  // Whether a side was split.
  Result<bool> StitchAll(std::span<const Side> sides) {
    const double tolerance = nearness_.sides;
    const std::vector<Side> border = BorderSides(sides);
    TRY(const TJunctions junctions,
        FindTJunctions(points_, triangles_, border, tolerance, cancel_));
    if (junctions.cut_short) {
      return Fail(Fault(FaultKind::kInvalidOption,
                        "Borders of the mesh lie on one another again and again: it cannot be "
                        "stitched.")
                      .Field("repair.stitch"));
    }
    if (junctions.found.empty()) return false;
    std::vector<std::uint32_t> joined, split_triangles;
    for (std::size_t begin = 0, end = 0; begin < junctions.found.size(); begin = end) {
      while (end < junctions.found.size() &&
             junctions.found[end].side == junctions.found[begin].side) {
        ++end;
      }
      const std::uint32_t side = junctions.found[begin].side;
      const auto [low, high] =
          std::minmax({SideStart(triangles_, side), SideEnd(triangles_, side)});
      std::vector<std::uint32_t>& inside = repair_.split[{low, high}];
      for (std::size_t i = begin; i < end; ++i) {
        const std::uint32_t v = junctions.found[i].vertex;
        // Of twins the first is joined; the others would make triangles of nothing.
        const bool twin =
            !inside.empty() && (Vec(points_[v]) - Vec(points_[inside.back()])).norm() <= tolerance;
        if (twin) continue;
        inside.push_back(v);
        joined.push_back(v);
      }
      split_triangles.push_back(repair_.triangle[side / 3]);
    }
    const std::size_t count = triangles_.size() + joined.size();
    if (count > limits_.max_triangles) {
      return Fail(
          Fault(FaultKind::kMeshTooLarge,
                fmt::format("Stitched, the mesh has {} triangles, more than max_triangles of "
                            "{}.",
                            count, limits_.max_triangles))
              .Field("mesh.triangles")
              .Detail("count", count)
              .Detail("quota", "max_triangles")
              .Detail("limit", limits_.max_triangles));
    }
    SplitTriangles(count);
    std::sort(joined.begin(), joined.end());
    joined.erase(std::unique(joined.begin(), joined.end()), joined.end());
    std::sort(split_triangles.begin(), split_triangles.end());
    split_triangles.erase(std::unique(split_triangles.begin(), split_triangles.end()),
                          split_triangles.end());
    AddWarning("split_triangles", split_triangles,
               fmt::format("{} triangles were split at {} T-junctions", split_triangles.size(),
                           joined.size()),
               repair_.warnings);
    return true;
  }

  void SplitTriangles(std::size_t count) {
    std::vector<Triangle> parts;
    std::vector<std::uint32_t> source;
    parts.reserve(count);
    source.reserve(count);
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      AppendParts(triangles_[t], {true, true, true}, parts);
      source.resize(parts.size(), repair_.triangle[t]);
    }
    triangles_ = std::move(parts);
    repair_.triangle = std::move(source);
  }

  // A fan from the corner opposite of the first of the `own` sides that is split. Each of the triangle's
  // other sides is then a side of one part, which is split there in its turn.
  void AppendParts(const Triangle& t, std::array<bool, 3> own, std::vector<Triangle>& parts) const {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t apex = t[k], from = t[(k + 1) % 3], to = t[(k + 2) % 3];
      const auto found = repair_.split.find({std::min(from, to), std::max(from, to)});
      if (!own[k] || found == repair_.split.end()) continue;
      std::vector<std::uint32_t> along = found->second;
      if (from > to) std::reverse(along.begin(), along.end());
      along.push_back(to);
      std::uint32_t last = from;
      for (const std::uint32_t v : along) {
        const bool first_own = v == to && own[(k + 1) % 3];
        const bool second_own = last == from && own[(k + 2) % 3];
        AppendParts({last, v, apex}, {first_own, second_own, false}, parts);
        last = v;
      }
      return;
    }
    parts.push_back(t);
  }

  std::span<const Point3> points_;
  std::vector<Triangle>& triangles_;
  const RepairOptions& options_;
  const MeshLimits& limits_;
  const CancelToken& cancel_;
  std::vector<Side> sides_;
  const Nearness nearness_;
  Repair repair_;
};

// A sentence with the numbers that follow "triangle" or "triangles" translated.
std::string GivenNumbers(std::string_view text, const Repair& repair) {
  constexpr std::string_view kWord = "riangle";
  constexpr std::string_view kBetween[] = {", and ", ", ", " and "};
  const auto is_digit = [](std::string_view s) {
    return !s.empty() && s.front() >= '0' && s.front() <= '9';
  };
  std::string out;
  const auto take = [&](std::size_t count) {
    out += text.substr(0, count);
    text.remove_prefix(count);
  };
  while (!text.empty()) {
    const std::size_t at = text.find(kWord);
    take(at == std::string_view::npos ? text.size() : at + kWord.size());
    for (const std::string_view more : {"s", ":", " "}) {
      if (text.starts_with(more)) take(more.size());
    }
    while (is_digit(text)) {
      std::uint32_t number = 0;
      const char* const end = text.data() + text.size();
      const auto [stop, error] = std::from_chars(text.data(), end, number);
      if (error != std::errc()) break;
      out += fmt::to_string(repair.TriangleOf(number));
      text.remove_prefix(static_cast<std::size_t>(stop - text.data()));
      for (const std::string_view between : kBetween) {
        if (!text.starts_with(between) || !is_digit(text.substr(between.size()))) continue;
        take(between.size());
        break;
      }
    }
  }
  return out;
}

}  // namespace

Triangle Repair::CornersOf(std::uint32_t given_triangle) const {
  Triangle corners = given[given_triangle];
  for (std::uint32_t& v : corners) v = vertex[v];
  return corners;
}

Repair::Parts Repair::PartsOf(std::uint32_t given_triangle) const {
  const auto at = std::lower_bound(dropped.begin(), dropped.end(),
                                   std::array<std::uint32_t, 2>{given_triangle, 0});
  if (at != dropped.end() && (*at)[0] == given_triangle) given_triangle = (*at)[1];
  const auto range = std::equal_range(triangle.begin(), triangle.end(), given_triangle);
  return {static_cast<std::uint32_t>(range.first - triangle.begin()),
          static_cast<std::uint32_t>(range.second - triangle.begin())};
}

Fault Repair::OfGiven(Fault fault) const {
  // Of these the elements are vertices.
  const bool vertices =
      fault.kind == FaultKind::kNonManifoldVertex || fault.kind == FaultKind::kNonFiniteCoordinate;
  const bool flips = fault.kind == FaultKind::kNotInjective &&
                     (fault.field == "pins" || !DetailOf(fault, "flipped").empty());
  const bool triangles = (fault.field == "mesh.triangles" && !vertices) || flips;
  if (!changed() || !triangles || fault.elements.empty()) return fault;
  for (std::uint32_t& element : fault.elements) element = TriangleOf(element);
  fault.message = GivenNumbers(fault.message, *this);
  return fault;
}

Warning Repair::OfGiven(Warning warning) const {
  constexpr const char* kOfTriangles[] = {"reversed_triangles", "degenerate_triangles",
                                          "split_edges", "doubled_triangles"};
  const bool triangles = std::find(std::begin(kOfTriangles), std::end(kOfTriangles),
                                   warning.kind) != std::end(kOfTriangles);
  if (!changed() || !triangles) return warning;
  for (std::uint32_t& element : warning.elements) element = TriangleOf(element);
  return warning;
}

std::vector<std::array<std::uint32_t, 2>> Repair::OfMended(
    std::vector<std::array<std::uint32_t, 2>> edges) const {
  for (std::size_t i = 0, count = edges.size(); i < count; ++i) {
    edges[i] = {VertexOf(edges[i][0]), VertexOf(edges[i][1])};
    const auto [low, high] = std::minmax({edges[i][0], edges[i][1]});
    const auto found = split.find({low, high});
    if (found == split.end()) continue;
    std::uint32_t last = found->second.front();
    edges[i] = {low, last};
    for (const std::uint32_t v : std::span(found->second).subspan(1)) {
      edges.push_back({last, v});
      last = v;
    }
    edges.push_back({last, high});
  }
  return edges;
}

EnergyOptions Repair::OfMended(EnergyOptions options) const {
  if (!changed() || options.rigidity.empty()) return options;
  std::vector<double> mended;
  mended.reserve(triangle.size());
  for (const std::uint32_t t : triangle) mended.push_back(options.rigidity[t]);
  options.rigidity = std::move(mended);
  return options;
}

Status CheckRepair(const RepairOptions& options) {
  // Written so that NaN fails too.
  const double tolerance = options.tolerance.value_or(0);
  if (tolerance >= 0 && std::isfinite(tolerance)) return {};
  return Fail(Fault(FaultKind::kInvalidOption,
                    fmt::format("A repair tolerance of {} is not a finite number of at least 0.",
                                tolerance))
                  .Field("repair.tolerance")
                  .Detail("value", tolerance));
}

Result<Repair> RepairTriangles(std::span<const Point3> points, std::vector<Triangle>& triangles,
                               const RepairOptions& options, const MeshLimits& limits,
                               const CancelToken& cancel, std::vector<Side>* sides) {
  CHECK_OK(CheckRepair(options));
  Mender mender(points, triangles, options, limits, cancel);
  TRY(auto repair, mender.Run());
  if (sides != nullptr) {
    *sides = mender.TakeSides();
    if (sides->empty()) *sides = SortedSides(points.size(), triangles);
  }
  if (!triangles.empty()) return repair;
  return Fail(Fault(FaultKind::kEmptyMesh,
                    "All triangles are smaller than the tolerance of welding: nothing is left.")
                  .Field("mesh.triangles"));
}

std::vector<Point3> InSpace(std::span<const Complex> points) {
  std::vector<Point3> space;
  space.reserve(points.size());
  for (const Complex p : points) space.push_back({p.real(), p.imag(), 0});
  return space;
}

}  // namespace arap
