#include "core/mesh/defects.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/base/try.h"
#include "core/mesh/space.h"
#include "core/mesh/t_junctions.h"
#include "core/mesh/twins.h"
#include "core/mesh/validation.h"

namespace arap {
namespace {

// A tolerance below this part of the diagonal is none.
constexpr double kNoTolerance = 1e-12;

std::vector<std::uint32_t> UsedVertices(std::size_t count, std::span<const Triangle> triangles) {
  std::vector<bool> used(count, false);
  for (const Triangle& t : triangles) {
    for (const std::uint32_t v : t) used[v] = true;
  }
  std::vector<std::uint32_t> ids;
  for (std::uint32_t v = 0; v < count; ++v) {
    if (used[v]) ids.push_back(v);
  }
  return ids;
}

// Whether the corners, in turn from the lowest, go up.
bool Ascends(Triangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t[1] < t[2];
}

}  // namespace

Nearness NearnessOf(std::span<const Point3> points, std::span<const Triangle> triangles,
                    const RepairOptions& options) {
  Nearness nearness;
  nearness.diagonal = DiagonalOf(points, triangles);
  nearness.places = options.tolerance.value_or(kRepairTolerance * nearness.diagonal);
  nearness.sides = std::max(nearness.places, kNoTolerance * nearness.diagonal);
  if (nearness.places < nearness.sides) nearness.places = 0;
  return nearness;
}

std::vector<std::uint32_t> WeldedVertices(std::span<const Point3> points,
                                          std::span<const Triangle> triangles, double tolerance) {
  const auto ids = UsedVertices(points.size(), triangles);
  const auto twins = FirstTwins(points, ids, tolerance);
  std::vector<std::uint32_t> vertex(points.size());
  std::iota(vertex.begin(), vertex.end(), 0u);
  for (std::size_t i = 0; i < ids.size(); ++i) vertex[ids[i]] = twins[i];
  return vertex;
}

Duplicates FindDuplicates(std::span<const Triangle> triangles) {
  std::vector<std::array<std::uint32_t, 4>> keys;  // ascending corners, triangle
  keys.reserve(triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    if (Collapsed(triangles[t])) continue;
    Triangle corners = triangles[t];
    std::sort(corners.begin(), corners.end());
    keys.push_back({corners[0], corners[1], corners[2], t});
  }
  std::sort(keys.begin(), keys.end());
  Duplicates found;
  for (std::size_t first = 0, i = 1; i < keys.size(); ++i) {
    if (!std::equal(keys[i].begin(), keys[i].begin() + 3, keys[first].begin())) {
      first = i;
      continue;
    }
    found.pairs.push_back({keys[i][3], keys[first][3]});
    if (Ascends(triangles[keys[i][3]]) != Ascends(triangles[keys[first][3]])) ++found.opposite;
  }
  std::sort(found.pairs.begin(), found.pairs.end());
  return found;
}

std::vector<std::uint32_t> Duplicates::triangles() const {
  std::vector<std::uint32_t> ids;
  for (const auto& pair : pairs) ids.push_back(pair[0]);
  return ids;
}

std::string Duplicates::WhichWay() const {
  if (opposite == 0) return "all run the same way: doubled";
  return fmt::format("{} of them run the other way: both sides of a sheet", opposite);
}

Result<std::vector<Warning>> FindDefects(std::span<const Point3> points,
                                         std::span<const Triangle> triangles,
                                         std::span<const Side> sides, const RepairOptions& options,
                                         const Nearness& nearness, const CancelToken& cancel) {
  std::vector<Warning> warnings;
  if (!std::isfinite(nearness.diagonal) || (options.weld && options.stitch)) return warnings;
  const std::vector<Side> border = BorderSides(sides);
  if (border.empty()) return warnings;
  if (!options.weld) {
    std::vector<std::uint32_t> ids;
    for (const Side& side : border) ids.insert(ids.end(), {side.v0, side.v1});
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    const auto first = FirstTwins(points, ids, nearness.places);
    if (first != ids) {
      // Doubled sheets with vertices of their own would become closed if their borders were welded.
      const auto vertex = WeldedVertices(points, triangles, nearness.places);
      std::vector<Triangle> welded(triangles.begin(), triangles.end());
      for (Triangle& t : welded) {
        for (std::uint32_t& v : t) v = vertex[v];
      }
      const Duplicates doubled = FindDuplicates(welded);
      std::vector<bool> of_doubled(points.size(), false);
      for (const auto& pair : doubled.pairs) {
        for (const std::uint32_t v : triangles[pair[0]]) of_doubled[v] = true;
      }
      std::vector<std::uint32_t> twins;
      for (std::size_t i = 0; i < ids.size(); ++i) {
        if (first[i] != ids[i] && !of_doubled[ids[i]]) twins.push_back(ids[i]);
      }
      AddWarning(
          "twin_vertices", twins,
          fmt::format("{} vertices of the border lie where others lie, within {:.3g}: the mesh "
                      "is open there; weld joins it",
                      twins.size(), nearness.places),
          warnings);
      AddWarning(
          "doubled_triangles", doubled.triangles(),
          fmt::format("{} triangles lie on others; {}; weld with drop_duplicates leaves one of "
                      "each",
                      doubled.pairs.size(), doubled.WhichWay()),
          warnings);
    }
  }
  if (!options.stitch) {
    TRY(const TJunctions junctions,
        FindTJunctions(points, triangles, border, nearness.sides, cancel));
    std::vector<std::uint32_t> vertices;
    for (const TJunction& junction : junctions.found) vertices.push_back(junction.vertex);
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    AddWarning(
        "t_junctions", vertices,
        fmt::format("{}{} T-junctions: vertices of the border inside edges of the border, where "
                    "the mesh is open; stitch joins it",
                    junctions.cut_short ? "at least " : "", vertices.size()),
        warnings);
  }
  return warnings;
}

Fault WithDefects(Fault fault, const std::vector<Warning>& warnings) {
  const auto is_defect = [](const Warning& w) {
    return w.kind == "twin_vertices" || w.kind == "doubled_triangles" || w.kind == "t_junctions";
  };
  const auto defect = std::find_if(warnings.begin(), warnings.end(), is_defect);
  if (defect == warnings.end()) return fault;
  if (fault.message.ends_with('.')) fault.message.pop_back();
  fault.message += fmt::format("; {}.", defect->message);
  return fault;
}

}  // namespace arap
