#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "arap/core/flattener.h"
#include "core/mesh/topology.h"

namespace arap {
namespace {

// Counts the sets of vertices that triangles join: their number, and the members of the largest.
class Parts {
 public:
  explicit Parts(std::size_t members) : sets_(members), used_(members, false) {}

  void Join(std::uint32_t a, std::uint32_t b) {
    sets_.Join(a, b);
    used_[a] = used_[b] = true;
  }

  void Count(SurfaceSize& size) {
    std::vector<std::uint32_t> members(used_.size(), 0);
    size.charts = size.largest = 0;
    for (std::uint32_t v = 0; v < used_.size(); ++v) {
      if (!used_[v]) continue;
      const std::uint32_t count = ++members[sets_.Find(v)];
      if (count == 1) ++size.charts;
      size.largest = std::max<std::size_t>(size.largest, count);
    }
  }

 private:
  UnionFind sets_;
  std::vector<bool> used_;
};

// Iterations that a descent seldom needs more of to bring less than kServiceRefineStop.
constexpr int kUsualRefinements = 20;

// Microseconds that the parts of a flattening take, for each vertex of a chart of `n` vertices.
// Factors fill with n log n numbers; beyond the caches they cost more.
struct VertexCost {
  explicit VertexCost(std::size_t n)
      : log(std::log2(static_cast<double>(std::max<std::size_t>(n, 2)))),
        far(std::sqrt(static_cast<double>(n) / 1e4)) {}

  double Similarity(bool edge_cells) const {
    const double fill = std::max(log - 4, 0.5);
    return edge_cells ? 0.25 * fill + 1.6 * far * std::sqrt(far) : 0.04 * fill + 0.18 * far;
  }
  double Rigid() const { return 0.045 * std::max(log - 4, 0.5) + 0.03 * far; }
  double Order() const { return 0.5; }
  double Spectral(bool edge_cells) const { return 0.1 + (edge_cells ? 0.26 : 0.13) * far * far; }
  double Angles() const { return 9 + 4 * far; }  // of an interior vertex
  double Iteration() const { return 0.055 + 0.022 * far; }
  double Injective() const { return 12 + 4 * far; }

  double log, far;
};

// Bytes for each vertex of the largest chart, while it is laid flat.
double LayoutBytes(const FlattenOptions& options, double log) {
  const bool edges = options.energy.basis != Basis::kFace;
  double bytes = std::max(380 + 37 * log, 170 * log - 1870);
  if (options.method == FlattenMethod::kAbf) {
    bytes = 2000 + 60 * log;
  } else if (edges) {
    bytes = std::max({300.0, 260 * log - 1100, 400 * log - 3150});
  }
  return options.injective ? std::max(bytes, 2000 + 140 * log) : bytes;
}

bool SolvesForPins(const FlattenOptions& options) {
  return options.pins.size() > 1 && options.pins.size() <= kDirectPins;
}

}  // namespace

SurfaceSize SizeOf(const SurfaceMesh& mesh, const CutOptions& cut) {
  const std::size_t vertices = mesh.vertices.size();
  const auto known = [vertices](const Triangle& t) {
    return t[0] < vertices && t[1] < vertices && t[2] < vertices && t[0] != t[1] && t[1] != t[2] &&
           t[2] != t[0];
  };
  SurfaceSize size{vertices, mesh.triangles.size()};
  if (cut.repair.weld || cut.repair.stitch) {
    // What parts it will have is not known before: as if it were one chart, which is the most that it
    // can take. A chart has two vertices more than triangles at most.
    size.charts = 1;
    size.largest = std::min(vertices, mesh.triangles.size() + 2);
    if (cut.repair.stitch) size.triangles += vertices;
    return size;
  }
  if (!cut.split_non_manifold) {
    Parts parts(vertices);
    for (const Triangle& t : mesh.triangles) {
      if (!known(t)) continue;
      parts.Join(t[0], t[1]);
      parts.Join(t[0], t[2]);
    }
    parts.Count(size);
    return size;
  }
  // Members are triangles, joined where exactly two have an edge; each has half a vertex and a
  // little.
  std::vector<Triangle> triangles;
  std::copy_if(mesh.triangles.begin(), mesh.triangles.end(), std::back_inserter(triangles), known);
  Parts parts(triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) parts.Join(t, t);
  ForEachEdge(SortedSides(vertices, triangles), [&parts](std::span<const Side> edge) {
    if (edge.size() == 2) parts.Join(edge[0].triangle(), edge[1].triangle());
  });
  parts.Count(size);
  size.largest = size.largest / 2 + 2;
  size.vertices = std::max(vertices, triangles.size() / 2 + 2 * size.charts);
  return size;
}

FlattenCost EstimateFlatten(const SurfaceSize& size, const FlattenOptions& options, bool keep) {
  const bool edges = options.energy.basis != Basis::kFace;
  const bool abf = options.method == FlattenMethod::kAbf;
  const bool spectral = options.anchors == FlattenAnchors::kSpectral;
  const auto vertices = static_cast<double>(size.vertices);
  const auto triangles = static_cast<double>(size.triangles);
  // A seam parts a chart at most once in three edges.
  const std::size_t most_charts = size.charts + options.cut.seams.size() / 3;
  const auto charts = static_cast<double>(most_charts);
  const std::size_t largest = size.largest > 0 ? size.largest : size.vertices;
  const VertexCost cost(largest);
  double total = 0.6 * triangles + 15 * charts;  // microseconds
  double micros = cost.Similarity(edges && !abf) + cost.Order();
  if (spectral) micros += cost.Spectral(edges && !abf);
  int iterations = options.refine;
  if (options.refine_stop >= kServiceRefineStop)
    iterations = std::min(iterations, kUsualRefinements);
  if (options.method == FlattenMethod::kArap) ++iterations;
  if (iterations > 0) {
    micros += cost.Rigid();
    total += 8 * charts;
  }
  // EDGE cells are refined with FACE cells, which are factored too.
  if (options.method == FlattenMethod::kArap && edges && options.refine > 0) micros += cost.Rigid();
  micros += iterations * cost.Iteration();
  if (SolvesForPins(options)) {
    total += 2.6 * static_cast<double>(options.pins.size()) * cost.Iteration() *
             static_cast<double>(largest);
  }
  if (options.injective) micros += cost.Injective();
  total += vertices * micros;
  if (abf) total += std::max(0.0, triangles - vertices + 2 * charts) * cost.Angles();
  if (options.cut.auto_cut) total += 2.5 * triangles;

  // Surfaces with EDGE cells or angles have the edges, too, and those that are kept.
  double bytes = 4e5 + (edges || abf || keep ? 340 : 270) * vertices + 900 * charts;
  double layout = LayoutBytes(options, cost.log);
  if (SolvesForPins(options)) layout += 350;
  bytes += layout * static_cast<double>(largest);
  // The factors of all charts stay, of ARAP those of both steps; those of the largest are partly what it
  // took to lay it flat. Tiny charts have no fill.
  if (keep) {
    const bool both = options.method == FlattenMethod::kArap;
    const auto large = static_cast<double>(largest);
    bytes += (both ? 0.5 : 0.15) * layout * large +
             std::min((both ? 0.95 : 0.6) * layout, 38 * large) * (vertices - large);
    total += 30 * charts;
  }
  return {1e-3 * total, static_cast<std::size_t>(bytes)};
}

}  // namespace arap
