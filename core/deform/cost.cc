#include "arap/core/cost.h"

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "core/base/try.h"
#include "core/deform/compiled_parts.h"
#include "core/deform/registered_parts.h"

namespace arap {
namespace {

// What was measured, in milliseconds per vertex, byte or row; docs/operations.md says where.
constexpr double kValidateVertex = 4e-3;  // validation, topology, cells, matrices
constexpr double kFactorVertex = 5.5e-6;  // both factorisations, per n^1.5
constexpr double kSolveByte = 0.35e-6;    // one pass over a factor, a few columns
constexpr double kSparseSolveByte = 0.5e-6;
constexpr double kStepVertex = 60e-6;     // a rigid step beside its solve
constexpr double kFrameVertex = 50e-6;    // targets, step 1 beside its rows, measures
constexpr double kColumnNumber = 0.5e-6;  // a number of a response, added to a shape
constexpr double kRow = 60e-6;            // a row of a frame: its target, its error
constexpr double kDepthVertex = 1.5e-6;   // a vertex in the cone of one handle
constexpr double kBoxTriangle = 12e-6;    // a triangle put into boxes
constexpr double kPick = 2e-3;
constexpr double kDenseOperation = 0.5e-6;  // of a factorisation of a dense matrix

void Count(const Row& row, RowCount& count) {
  ++count.rows;
  if (row.compliance == 0 && row.single_vertex() == kNone) ++count.inside;
}

double Cube(std::size_t n) { return std::pow(static_cast<double>(n), 3); }

struct Sizes {
  double vertices, triangles, similarity, rigid;  // the last two in bytes of the factors
};
Sizes SizesOf(const RegisteredMesh& mesh) {
  const RegisteredMeshParts& parts = mesh.parts();
  return {static_cast<double>(parts.rest.size()), static_cast<double>(parts.mesh.triangles.size()),
          static_cast<double>(parts.similarity->bytes()),
          static_cast<double>(parts.rigid->bytes())};
}

// Factors and tables of a mesh, without the peak on the way.
double RegistrationPeak(double n) { return n * (700 + 130 * std::log2(n + 2)); }

// Of a set with `rows`, of which `solved` are new and need their responses.
Cost CostOfRows(const RegisteredMesh& mesh, const RowCount& rows, std::size_t solved,
                bool factors) {
  const Sizes size = SizesOf(mesh);
  Cost cost;
  cost.milliseconds = 0.1 + kBoxTriangle * size.triangles + kRow * static_cast<double>(rows.rows) +
                      kDepthVertex * size.vertices * static_cast<double>(rows.depths);
  double bytes = static_cast<double>(rows.rows) * 2 * sizeof(Row) + 2 * 8 * size.vertices;
  if (factors) {
    const double k = static_cast<double>(rows.inside);
    cost.milliseconds += kValidateVertex / 2 * size.vertices +
                         kFactorVertex * std::pow(size.vertices, 1.5) +
                         k * kSparseSolveByte * (size.similarity + size.rigid) +
                         kDenseOperation * 5 * Cube(rows.inside);
    bytes += RegistrationPeak(size.vertices) + k * k * 5 * sizeof(double);
  } else {
    const double k = static_cast<double>(rows.rows), added = static_cast<double>(solved);
    cost.milliseconds += added * (kSparseSolveByte * (size.similarity + size.rigid) / 2 +
                                  3 * kColumnNumber * size.vertices) +
                         kDenseOperation * 5 * k * k * k;
    bytes += added * 3 * sizeof(double) * size.vertices + 7 * 8 * size.vertices * 4 +
             k * k * 6 * sizeof(double);
  }
  cost.bytes = static_cast<std::size_t>(bytes);
  return cost;
}

}  // namespace

Cost EstimateRegistration(std::size_t vertices, Basis) {
  const auto n = static_cast<double>(vertices);
  return {0.1 + kValidateVertex * n + kFactorVertex * std::pow(n, 1.5),
          static_cast<std::size_t>(RegistrationPeak(n))};
}

Result<RowCount> CountRows(const RegisteredMesh& mesh, const std::vector<Handle>& handles,
                           const CancelToken& cancel) {
  TRY(const auto placements, PlaceHandles(mesh.parts(), handles, cancel));
  RowCount count;
  for (const Placement& placement : placements) {
    for (const Row& row : placement.rows) Count(row, count);
    if (placement.placed.handle.depth != 0) ++count.depths;
  }
  return count;
}

RowCount CountRows(const CompiledHandles& handles) {
  RowCount count;
  for (const Row& row : handles.parts().rows) Count(row, count);
  for (const PlacedHandle& h : handles.handles()) count.depths += h.handle.depth != 0 ? 1u : 0u;
  return count;
}

Cost EstimateCompilation(const RegisteredMesh& mesh, const RowCount& rows) {
  return CostOfRows(mesh, rows, rows.rows, FactorsDirectly(rows.rows, HandleSolver::kAuto));
}

EditCost EstimateEdit(const CompiledHandles& handles, std::span<const std::string> remove,
                      const RowCount& added) {
  const CompiledHandlesParts& set = handles.parts();
  std::unordered_set<std::size_t> removed;
  for (const std::string& id : remove) {
    if (const auto index = handles.Find(id)) removed.insert(*index);
  }
  RowCount after = added;
  for (const Row& row : set.rows) {
    if (!removed.contains(row.handle)) Count(row, after);
  }
  for (std::size_t h = 0; h < set.handles.size(); ++h) {
    if (set.handles[h].handle.depth != 0 && !removed.contains(h)) ++after.depths;
  }
  // A set that was factored directly has no responses of the rows that stay.
  const std::size_t solved = set.responses ? added.rows : after.rows;
  const bool factors = FactorsDirectly(after.rows, set.choice);
  return {CostOfRows(*set.mesh, after, solved, factors), factors};
}

Cost EstimateFrame(const CompiledHandles& handles, const DeformOptions& options,
                   std::size_t picks) {
  const CompiledHandlesParts& set = handles.parts();
  const Sizes size = SizesOf(*set.mesh);
  const auto rows = static_cast<double>(set.rows.size());
  double steps = options.mode == DeformMode::kSimilarity ? 0 : 1;
  if (options.mode == DeformMode::kRigid) steps += options.refine;
  // Per step and for step 1: solves, and columns that are added to the shape.
  double solve1 = 0, solve2 = kSolveByte * size.rigid, column1 = 0, column2 = 0;
  if (handles.direct()) {
    const RowCount count = CountRows(handles);
    const double times = count.inside > 0 ? 2 : 1;
    solve1 = times * kSolveByte * size.similarity;
    solve2 *= times;
  } else {
    column1 = 4 * rows * kColumnNumber * size.vertices;
    column2 = 2 * rows * kColumnNumber * size.vertices;
  }
  Cost cost;
  cost.milliseconds = 0.02 + kFrameVertex * size.vertices + kRow * rows + solve1 + column1 +
                      steps * (kStepVertex * size.vertices + solve2 + column2);
  cost.bytes = 0;
  if (picks > 0) {
    cost.milliseconds += kBoxTriangle * size.triangles + kPick * static_cast<double>(picks);
    cost.bytes = static_cast<std::size_t>(8 * size.triangles) + picks * 64;
  }
  return cost;
}

std::size_t DeformerBytes(const CompiledHandles& handles, std::size_t lanes) {
  // Per lane: the shape, the last one and the next, and its force. For all: a solution of every
  // lane, and the rows that a solve has in its order.
  std::size_t numbers = lanes * 8 + std::max<std::size_t>(2 * lanes, 2) + 4;
  if (handles.direct()) numbers += 2;
  if (CountRows(handles).inside > 0) numbers += 6;
  return numbers * sizeof(double) * handles.mesh()->mesh().vertices.size() +
         handles.rows() * (lanes + 4) * 2 * sizeof(double);
}

}  // namespace arap
