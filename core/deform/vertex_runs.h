// Vertex runs: neighbouring vertices of one component, which move together where no handle bends them. A frame passes
// over the shape run by run, several vertices at a time. For this folder only.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "arap/model/mesh.h"

namespace arap {

// Vertices [begin, end) of one component, or of no triangle (kNone).
struct VertexRun {
  std::uint32_t begin = 0, end = 0;
  std::uint32_t component = 0;
};

// All vertices in order. `component` is Topology::vertex_component (#V).
std::vector<VertexRun> RunsOf(std::span<const std::uint32_t> component);

// Calls visit(run) for what lies in [begin, end) of every run.
template <class Visit>
void ForRunsIn(std::span<const VertexRun> runs, std::size_t begin, std::size_t end, Visit visit) {
  auto run = std::partition_point(runs.begin(), runs.end(),
                                  [&](const VertexRun& each) { return each.end <= begin; });
  for (; run != runs.end() && run->begin < end; ++run) {
    visit(VertexRun{static_cast<std::uint32_t>(std::max<std::size_t>(run->begin, begin)),
                    static_cast<std::uint32_t>(std::min<std::size_t>(run->end, end)),
                    run->component});
  }
}

// Vertices that a thread passes over in one piece.
inline constexpr std::size_t kVertexRange = std::size_t{1} << 14u;

// p ↦ place + turn·(p − from)
struct Similarity {
  Complex from, place, turn;
};

// shape := similarity(rest) and shape += similarity(rest), over the run. The same bytes on every processor, as for all
// of these. `rest` and `shape` are #V.
void SetToSimilarity(const VertexRun& run, std::span<const Complex> rest,
                     const Similarity& similarity, std::span<Complex> shape);
void AddSimilarityOf(const VertexRun& run, std::span<const Complex> rest,
                     const Similarity& similarity, std::span<Complex> shape);

// shape += by, over the run.
void Shift(const VertexRun& run, Complex by, std::span<Complex> shape);

// shape += added, all vertices.
void AddShape(std::span<const Complex> added, std::span<Complex> shape);

// positions := origin + unit·(shape + middle), over the run. False when a number is not finite.
bool ToUnits(const VertexRun& run, std::span<const Complex> shape, Complex middle, double unit,
             Complex origin, std::span<Complex> positions);

}  // namespace arap
