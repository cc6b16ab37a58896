#include "arap/core/registered_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "core/base/plane.h"
#include "core/base/try.h"
#include "core/deform/registered_parts.h"
#include "core/energy/assemble.h"
#include "core/energy/cells.h"
#include "core/mesh/locate.h"
#include "core/mesh/repair.h"
#include "core/mesh/validation.h"
#include "core/sparse/elimination_order.h"

namespace arap {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

// The vertex of each component whose distance from its component's `from` point is nearest to
// `wanted`; `skip` is left out.
std::vector<std::uint32_t> NearestToDistance(const RegisteredMeshParts& parts,
                                             const std::vector<Complex>& from,
                                             const std::vector<double>& wanted,
                                             const std::vector<std::uint32_t>& skip) {
  std::vector<std::uint32_t> best(from.size(), kNone);
  std::vector<double> error(from.size(), kInf);
  for (std::uint32_t v = 0; v < parts.rest.size(); ++v) {
    const std::uint32_t c = parts.topology.vertex_component[v];
    if (c == kNone || skip[c] == v) continue;
    const double e = std::abs(std::abs(parts.rest[v] - from[c]) - wanted[c]);
    if (e < error[c]) best[c] = v, error[c] = e;
  }
  return best;
}

void PlaceComponents(RegisteredMeshParts& parts) {
  const std::size_t count = parts.topology.components;
  std::vector<Bounds> boxes(count);
  for (std::size_t v = 0; v < parts.rest.size(); ++v) {
    const std::uint32_t c = parts.topology.vertex_component[v];
    if (c != kNone) boxes[c].Add(parts.rest[v]);
  }
  std::vector<Complex> from(count);
  std::vector<double> wanted(count, 0);
  for (std::size_t c = 0; c < count; ++c) from[c] = boxes[c].center();
  const auto first =
      NearestToDistance(parts, from, wanted, std::vector<std::uint32_t>(count, kNone));
  for (std::size_t c = 0; c < count; ++c) {
    from[c] = parts.rest[first[c]];
    wanted[c] = 0.25 * boxes[c].diagonal();
  }
  const auto second = NearestToDistance(parts, from, wanted, first);
  for (std::size_t c = 0; c < count; ++c) {
    parts.components.push_back({boxes[c].center(), first[c], second[c]});
  }
}

void Normalise(RegisteredMeshParts& parts) {
  const Bounds box = BoundsOf(parts.mesh.vertices, parts.mesh.triangles);
  parts.origin = box.center();
  parts.report.diagonal = box.diagonal();
  parts.rest.reserve(parts.mesh.vertices.size());
  for (const Complex p : parts.mesh.vertices) parts.rest.push_back(parts.Normalise(p));
}

// Whether halving the mesh leaves less fill than minimum degree. What counts is how long its boundary is beside a side of a
// square of as many vertices: 4 for a square, 5 for a strip of 1 to 4, where there is little to gain any more; more for a
// character, which minimum degree eliminates from its limbs.
bool IsLargeAndCompact(const RegisteredMeshParts& parts) {
  constexpr std::size_t kLarge = 25'000;
  constexpr double kCompact = 5;
  const std::size_t vertices = parts.rest.size();
  if (vertices < kLarge) return false;
  const auto boundary = std::count_if(parts.topology.edges.begin(), parts.topology.edges.end(),
                                      [](const Edge& edge) { return edge.boundary(); });
  return static_cast<double>(boundary) <= kCompact * std::sqrt(static_cast<double>(vertices));
}

// Empty leaves the order to the factor.
template <class Scalar>
Result<std::vector<int>> OrderOf(const RegisteredMeshParts& parts,
                                 const Eigen::SparseMatrix<Scalar>& lower) {
  if (!IsLargeAndCompact(parts)) return std::vector<int>();
  return EliminationOrder(lower, parts.rest);
}

Status Factorise(RegisteredMeshParts& parts, const CancelToken& cancel) {
  std::vector<bool> fixed(parts.rest.size(), false);
  for (std::size_t v = 0; v < fixed.size(); ++v) {
    fixed[v] = parts.topology.vertex_component[v] == kNone;
  }
  // One matrix after the other: on a large mesh each is a good part of all memory.
  for (const MeshComponent& c : parts.components) fixed[c.ground0] = fixed[c.ground1] = true;
  {
    const auto lower = AssembleSimilarity(parts.cells, fixed);
    TRY(const std::vector<int> order, OrderOf(parts, lower));
    TRY(parts.similarity, Factor<Complex>::Make(lower, FactorLayout::kPacked, order));
  }
  CHECK_OK(cancel.Check());

  for (const MeshComponent& c : parts.components) fixed[c.ground1] = false;
  // Both matrices of FACE cells have one pattern. Of other cells the order of step 1 would serve too, but leave a
  // third more numbers to read in every frame.
  const bool same = parts.options.basis == Basis::kFace;
  const auto lower = AssembleRigid(parts.cells, fixed);
  std::vector<int> own;
  if (!same) {
    TRY(own, OrderOf(parts, lower));
  }
  TRY(parts.rigid, Factor<double>::Make(lower, FactorLayout::kPacked,
                                        same ? parts.similarity->order() : std::span(own)));
  return cancel.Check();
}

// Mends the triangles; the warnings are about that, and about what could be mended.
Result<std::vector<Warning>> Mend(PlanarMesh& mesh, const RepairOptions& repairs,
                                  const MeshLimits& limits, const CancelToken& cancel,
                                  Repair& repair, std::vector<Side>& sides) {
  CHECK_OK(CheckArrays(mesh, limits));
  TRY(repair,
      RepairTriangles(InSpace(mesh.vertices), mesh.triangles, repairs, limits, cancel, &sides));
  return std::move(repair.warnings);
}

// Validates a mesh that was mended; what is said of it is said of the given triangles.
Result<std::vector<Warning>> ValidateMended(PlanarMesh& mesh, const Repair& repair,
                                            const MeshLimits& limits, std::vector<Side>& sides) {
  auto warnings = ValidatePlanar(mesh, limits, sides);
  if (!warnings) return Fail(repair.OfGiven(std::move(warnings.error())));
  if (!repair.changed()) return warnings;
  for (Warning& warning : *warnings) warning = repair.OfGiven(std::move(warning));
  // Those that others stand for are used too.
  std::erase_if(*warnings, [](const Warning& w) { return w.kind == "unreferenced_vertices"; });
  WarnUnreferenced(mesh.vertices.size(), repair.given, *warnings);
  return warnings;
}

// Rigidity is given for the triangles that were given.
Result<EnergyOptions> OptionsOfMended(const EnergyOptions& options, const Repair& repair) {
  if (!repair.changed()) return options;
  CHECK_OK(CheckEnergyOptions(options, repair.given.size()));
  return repair.OfMended(options);
}

void Report(std::vector<Warning> warnings, std::size_t clamped, RegisteredMeshParts& parts) {
  RegistrationReport& report = parts.report;
  report.vertices = parts.mesh.vertices.size();
  report.triangles = parts.given_triangles();
  report.edges = parts.topology.edges.size();
  report.components = parts.topology.components;
  report.boundary_loops = parts.topology.boundary_loops;
  for (const Triangle& t : parts.mesh.triangles) {
    report.area += 0.5 * TwiceArea(t, parts.rest);
  }
  report.area *= report.diagonal * report.diagonal;
  report.clamped_weights = clamped;
  report.warnings = std::move(warnings);
  if (clamped > 0) report.warnings.push_back(ClampedWarning(clamped));
  AddWarning("joint_vertices", parts.topology.joints,
             "parts of the mesh touch in a single vertex; they are welded there", report.warnings);
  report.bytes =
      parts.similarity->bytes() + parts.rigid->bytes() + parts.cells.bytes() +
      parts.rest.size() * 2 * sizeof(Complex) +
      parts.mesh.triangles.size() * (2 * sizeof(Triangle) + sizeof(std::uint32_t)) +
      parts.topology.edges.size() * sizeof(Edge) + parts.runs.size() * sizeof(VertexRun) +
      parts.repair.given.size() * sizeof(Triangle) +
      (parts.repair.vertex.size() + parts.repair.triangle.size()) * sizeof(std::uint32_t);
}

}  // namespace

RegisteredMesh::RegisteredMesh(std::unique_ptr<const RegisteredMeshParts> parts)
    : parts_(std::move(parts)) {}
RegisteredMesh::~RegisteredMesh() = default;

Status RegisteredMesh::CheckOptions(const EnergyOptions& options, std::size_t triangles) {
  return CheckEnergyOptions(options, triangles);
}

Result<std::shared_ptr<const RegisteredMesh>> RegisteredMesh::Register(PlanarMesh mesh,
                                                                       const EnergyOptions& options,
                                                                       const MeshLimits& limits,
                                                                       const CancelToken& cancel) {
  return Register(std::move(mesh), options, RepairOptions{}, limits, cancel);
}

Result<std::shared_ptr<const RegisteredMesh>> RegisteredMesh::Register(PlanarMesh mesh,
                                                                       const EnergyOptions& options,
                                                                       const RepairOptions& repairs,
                                                                       const MeshLimits& limits,
                                                                       const CancelToken& cancel) {
  return OrOutOfMemory([&] { return Make(std::move(mesh), options, repairs, limits, cancel); });
}

Result<std::shared_ptr<const RegisteredMesh>> RegisteredMesh::Make(PlanarMesh mesh,
                                                                   const EnergyOptions& options,
                                                                   const RepairOptions& repairs,
                                                                   const MeshLimits& limits,
                                                                   const CancelToken& cancel) {
  auto parts = std::make_unique<RegisteredMeshParts>();
  std::vector<Side> sides;
  TRY(auto warnings, Mend(mesh, repairs, limits, cancel, parts->repair, sides));
  CHECK_OK(cancel.Check());
  const std::vector<Triangle> given = mesh.triangles;
  TRY(auto more, ValidateMended(mesh, parts->repair, limits, sides));
  warnings.insert(warnings.end(), more.begin(), more.end());
  TRY(const EnergyOptions mended, OptionsOfMended(options, parts->repair));
  CHECK_OK(cancel.Check());

  parts->repairs = repairs;
  parts->mesh = std::move(mesh);
  parts->options = options;
  for (std::size_t t = 0; t < given.size(); ++t) {
    parts->turned.push_back(given[t] != parts->mesh.triangles[t]);
  }
  parts->topology = BuildTopology(parts->mesh.vertices.size(), parts->mesh.triangles, sides);
  sides = {};
  parts->runs = RunsOf(parts->topology.vertex_component);
  Normalise(*parts);
  PlaceComponents(*parts);
  parts->nearby = NearbyOrder(parts->rest, parts->mesh.triangles);
  CHECK_OK(cancel.Check());
  const TriangleFrame frame = [&](std::uint32_t t) {
    const Triangle& c = parts->mesh.triangles[t];
    return std::array<Complex, 3>{parts->rest[c[0]], parts->rest[c[1]], parts->rest[c[2]]};
  };
  TRY(CellSystem system, BuildCells(parts->mesh.triangles, parts->topology, mended, frame, true));
  parts->cells = std::move(system.cells);
  parts->stretch = StretchTable(parts->mesh, parts->rest);
  CHECK_OK(cancel.Check());
  CHECK_OK(Factorise(*parts, cancel));
  Report(std::move(warnings), system.clamped, *parts);
  return std::shared_ptr<const RegisteredMesh>(new RegisteredMesh(std::move(parts)));
}

const PlanarMesh& RegisteredMesh::mesh() const { return parts_->mesh; }
const EnergyOptions& RegisteredMesh::options() const { return parts_->options; }
const RepairOptions& RegisteredMesh::repairs() const { return parts_->repairs; }
const RegistrationReport& RegisteredMesh::report() const { return parts_->report; }

std::vector<std::uint32_t> RegisteredMesh::BoundaryVertices() const {
  std::vector<bool> on_it(mesh().vertices.size(), false);
  for (const Edge& edge : parts_->topology.edges) {
    if (edge.boundary()) on_it[edge.v0] = on_it[edge.v1] = true;
  }
  std::vector<std::uint32_t> vertices;
  for (std::uint32_t v = 0; v < on_it.size(); ++v) {
    if (on_it[v]) vertices.push_back(v);
  }
  return vertices;
}

}  // namespace arap
