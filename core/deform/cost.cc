#include "arap/core/cost.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>

#include "core/deform/compiled_parts.h"
#include "core/deform/registered_parts.h"

namespace arap {
namespace {

// What was measured, in milliseconds per vertex, byte or row, and a fifth more, as a busy machine has
// less of its caches; docs/operations.md says where.
constexpr double kSolveByte = 0.18e-6;      // one pass over a factor that no cache holds
constexpr double kResponseByte = 0.035e-6;  // a sparse right-hand side among others, both factors
constexpr double kResponseVertex = 20e-6;   // and its place among the responses
constexpr double kFrameVertex = 4e-6;       // a frame beside its steps and measures
constexpr double kColumnNumber = 0.4e-6;    // a number of a response, added to a shape
constexpr double kRow = 60e-6;              // a row of a frame: its target, its error
constexpr double kInsideNumber = 4e-6;      // of the square that hard rows inside triangles have
constexpr double kDepthVertex = 2e-6;       // a vertex in the cone of one handle
constexpr double kBoxTriangle = 22e-6;      // a triangle put into boxes
constexpr double kPick = 0.6e-3;
constexpr double kDenseOperation = 0.12e-6;  // of a factorisation of a dense matrix, cubed
constexpr double kDirect = 0.9;             // of a registration: mesh and handles factored together
constexpr std::size_t kSmallest = 200'000;  // bytes of a registration of almost nothing
constexpr double kCache = 30e6;             // bytes of a factor that are near the processor

// Registration of n vertices: n·(vertex + root·√n) ms, n·(bytes + logarithm·log2 n) bytes, and `direct`
// of these when handles are factored with it. A rigid step takes `step` ms for each vertex beside its
// solve, and so do the measures.
struct MeshCost {
  double vertex, root, bytes, logarithm, direct, step;

  double milliseconds(double n) const { return n * (vertex + root * std::sqrt(n)); }
  double peak(double n) const { return n * (bytes + logarithm * std::log2(n + 2)); }
};
MeshCost CostsOf(Basis basis) {
  switch (basis) {
    case Basis::kFace:
      return {2.2e-3, 0.0072e-3, 470, 80, 0.79, 9e-6};
    case Basis::kVertex:
      return {3.9e-3, 0.029e-3, 600, 180, 1, 42e-6};
    case Basis::kEdge:
    case Basis::kEdgeAsPublished:
      break;
  }
  return {2.9e-3, 0.0175e-3, 550, 138, 0.9, 15e-6};
}

struct Sizes {
  double vertices, triangles, similarity, rigid;  // the last two in bytes of the factors
};
Sizes SizesOf(const RegisteredMesh& mesh) {
  const RegisteredMeshParts& parts = mesh.parts();
  return {static_cast<double>(parts.rest.size()), static_cast<double>(parts.mesh.triangles.size()),
          static_cast<double>(parts.similarity->bytes()),
          static_cast<double>(parts.rigid->bytes())};
}

// What reading a factor costs beside doing so from memory.
double FromCache(double bytes) { return 0.3 + 0.7 * std::min(1.0, bytes / kCache); }

double SolveMilliseconds(double bytes) { return kSolveByte * bytes * FromCache(bytes); }

// Of a set with `rows`, of which `solved` are new and need their responses.
Cost CostOfRows(const RegisteredMesh& mesh, const RowCount& rows, std::size_t solved,
                bool factors) {
  const Sizes size = SizesOf(mesh);
  const double factors_bytes = size.similarity + size.rigid;
  const double response = kResponseByte * factors_bytes * FromCache(factors_bytes / 3) +
                          kResponseVertex * size.vertices;
  Cost cost;
  cost.milliseconds = 0.03 + kBoxTriangle * size.triangles + kRow * static_cast<double>(rows.rows) +
                      kDepthVertex * size.vertices * static_cast<double>(rows.depths);
  // A handle has one row at least, and an id.
  constexpr std::size_t kHandle = sizeof(PlacedHandle) + 160;
  double bytes = static_cast<double>(rows.rows) * (2 * sizeof(Row) + kHandle);
  if (rows.depths > 0) bytes += 8 * size.vertices;
  if (factors) {
    const auto k = static_cast<double>(rows.inside);
    const MeshCost costs = CostsOf(mesh.options().basis);
    // Vertices that are held are no unknowns.
    const double held = std::min(static_cast<double>(rows.held), size.vertices);
    cost.milliseconds += kDirect * costs.milliseconds(size.vertices - held) + k * response +
                         5 * kDenseOperation * k * k * k;
    bytes +=
        costs.direct * costs.peak(size.vertices - held) + 150 * held + 5 * k * k * sizeof(double);
  } else {
    const auto k = static_cast<double>(rows.rows), added = static_cast<double>(solved);
    cost.milliseconds += (added + 0.7) * response + 5 * kDenseOperation * k * k * k;
    // They are solved for eight at a time.
    bytes += (added * 3 * sizeof(double) + 55 + 15 * std::min(added, 8.0)) * size.vertices +
             k * k * 6 * sizeof(double);
  }
  cost.bytes = static_cast<std::size_t>(bytes);
  return cost;
}

}  // namespace

Cost EstimateRegistration(std::size_t vertices, Basis basis) {
  const auto n = static_cast<double>(vertices);
  const MeshCost costs = CostsOf(basis);
  return {0.1 + costs.milliseconds(n), kSmallest + static_cast<std::size_t>(costs.peak(n))};
}

const RowCount& CountRows(const CompiledHandles& handles) { return handles.parts().count; }

Cost EstimateCompilation(const RegisteredMesh& mesh, const RowCount& rows) {
  return CostOfRows(mesh, rows, rows.rows, FactorsDirectly(rows.rows, HandleSolver::kAuto));
}

EditCost EstimateEdit(const CompiledHandles& handles, std::span<const std::string> remove,
                      const RowCount& added) {
  const CompiledHandlesParts& set = handles.parts();
  RowCount gone;
  const std::set<std::string_view> ids(remove.begin(), remove.end());
  for (const std::string_view id : ids) {
    const auto index = handles.Find(id);
    if (!index) continue;
    if (set.handles[*index].handle.depth != 0) ++gone.depths;
    // The rows of a handle stand together, in the order of the handles.
    for (auto row = std::ranges::lower_bound(set.rows, static_cast<std::uint32_t>(*index), {},
                                             &Row::handle);
         row != set.rows.end() && row->handle == *index; ++row) {
      CountRow(*row, gone);
    }
  }
  const RowCount after{
      set.count.rows - gone.rows + added.rows, set.count.inside - gone.inside + added.inside,
      set.count.held - gone.held + added.held, set.count.depths - gone.depths + added.depths};
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
  const auto inside = static_cast<double>(set.count.inside);
  const double step = CostsOf(set.mesh->options().basis).step;
  double steps = options.mode == DeformMode::kSimilarity ? 0 : 1;
  if (options.mode == DeformMode::kRigid) steps += options.refine;
  // Per step and for step 1: solves, and columns that are added to the shape.
  double solve1 = 0, solve2 = SolveMilliseconds(size.rigid), column1 = 0, column2 = 0;
  if (handles.direct()) {
    const double times = inside > 0 ? 2 : 1;
    solve1 = times * SolveMilliseconds(size.similarity);
    solve2 *= times;
  } else {
    column1 = 4 * rows * kColumnNumber * size.vertices;
    column2 = 2 * rows * kColumnNumber * size.vertices;
  }
  Cost cost;
  cost.milliseconds = 0.005 + (kFrameVertex + step) * size.vertices + kRow * rows + solve1 +
                      column1 + steps * (step * size.vertices + solve2 + column2);
  if (handles.direct()) cost.milliseconds += (1 + steps) / 2 * kInsideNumber * inside * inside;
  cost.bytes = 0;
  if (picks > 0) {
    cost.milliseconds += kBoxTriangle * size.triangles + kPick * static_cast<double>(picks);
    cost.bytes = static_cast<std::size_t>(8 * size.triangles) + picks * 64;
  }
  return cost;
}

std::size_t DeformerBytes(const CompiledHandles& handles, std::size_t lanes, bool crew) {
  // Per lane: the shape, the last one and the next, and its force. For all: a solution of every
  // lane, and the rows that a solve has in its order.
  std::size_t numbers = lanes * 8 + std::max<std::size_t>(2 * lanes, 2) + 4;
  if (handles.direct()) numbers += 2;
  if (CountRows(handles).inside > 0) numbers += 6;
  const std::size_t vertices = handles.mesh()->mesh().vertices.size();
  std::size_t bytes =
      numbers * sizeof(double) * vertices + handles.rows() * (lanes + 4) * 2 * sizeof(double);
  // Forces that wait to be added, and the rows of the factor's top once for each of its parts.
  constexpr std::size_t kForces = 2'200'000, kTopRows = 2;
  if (crew) bytes += kForces + kTopRows * vertices;
  return bytes;
}

}  // namespace arap
