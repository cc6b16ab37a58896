#include "core/flatten/flattener.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/energy/assemble.h"
#include "core/energy/build_cells.h"
#include "core/energy/local_step.h"
#include "core/flatten/disk.h"
#include "core/sparse/factor.h"

namespace arap {
namespace {

// One surface on its way to the plane, normalised to a unit diagonal.
class Flattener {
 public:
  Flattener(SurfaceMesh mesh, Topology topology)
      : mesh_(std::move(mesh)),
        topology_(std::move(topology)),
        component_(mesh_.vertices.size(), 0) {
    for (const Triangle& t : mesh_.triangles) frames_.push_back(LayFlat(mesh_, t));
    const Edge& edge = topology_.edges[CentreEdge(mesh_, topology_)];
    anchors_ = {edge.v0, edge.v1};
  }

  const SurfaceMesh& mesh() const { return mesh_; }
  std::array<std::uint32_t, 2> anchors() const { return anchors_; }

  Result<CellSystem> Cells(const EnergyOptions& options) const {
    const TriangleFrame frame = [this](std::uint32_t t) { return frames_[t]; };
    return BuildCells(mesh_.triangles, topology_, options, frame, false);
  }

  // Step 1: the centre edge fixed at 0 and at its length, everything else as similar as possible.
  Result<std::vector<Complex>> FirstStep(const arap::Cells& cells) const {
    const double length = (mesh_.vertices[anchors_[1]] - mesh_.vertices[anchors_[0]]).norm();
    const std::vector<bool> fixed = Fixed(2);
    auto factor =
        Factor<Complex>::Make(AssembleSimilarity(cells, fixed), FactorLayout::kSupernodal);
    if (!factor) return Fail(std::move(factor.error()));
    std::vector<Complex> right = SimilarityColumn(cells, fixed.size(), anchors_[1]);
    for (std::size_t v = 0; v < right.size(); ++v) right[v] = fixed[v] ? 0 : -length * right[v];
    right[anchors_[1]] = length;
    Workspace workspace;
    const auto solution = (*factor)->Solve(right, 1, workspace);
    if (solution.empty())
      return Fail(FaultKind::kNumerical, "a back-substitution ran out of memory");
    return std::vector<Complex>(solution.begin(), solution.end());
  }

  // Step 2, `times` over: rotations from `shape`, then the rigid solve with one anchor.
  Status RigidSteps(const arap::Cells& cells, int times, const CancelToken& cancel,
                    std::vector<Complex>& shape) const {
    const std::vector<bool> fixed = Fixed(1);
    auto factor = Factor<double>::Make(AssembleRigid(cells, fixed), FactorLayout::kSimplicial);
    if (!factor) return Fail(std::move(factor.error()));
    const std::size_t n = shape.size();
    const std::vector<Complex> mean(1, 0);
    std::vector<double> v(2 * n), right(2 * n);
    for (std::size_t i = 0; i < n; ++i) v[i] = shape[i].real(), v[n + i] = shape[i].imag();
    Workspace workspace;
    for (int step = 0; step < times; ++step) {
      if (auto ok = cancel.Check(); !ok) return ok;
      std::fill(right.begin(), right.end(), 0.0);
      AddRotatedEdges(cells, {v.data(), v.data() + n}, mean, {right.data(), right.data() + n});
      for (std::size_t i = 0; i < n; ++i) {
        if (fixed[i]) right[i] = right[n + i] = 0;
      }
      const auto solution = (*factor)->Solve(right, 2, workspace);
      if (solution.empty()) {
        return Fail(FaultKind::kNumerical, "a back-substitution ran out of memory");
      }
      std::copy(solution.begin(), solution.end(), v.begin());
    }
    for (std::size_t i = 0; i < n; ++i) shape[i] = {v[i], v[n + i]};
    return {};
  }

 private:
  // Unreferenced vertices and the first `anchors` anchors.
  std::vector<bool> Fixed(std::size_t anchors) const {
    std::vector<bool> fixed(mesh_.vertices.size());
    for (std::size_t v = 0; v < fixed.size(); ++v)
      fixed[v] = topology_.vertex_component[v] == kNone;
    for (std::size_t k = 0; k < anchors; ++k) fixed[anchors_[k]] = true;
    return fixed;
  }

  SurfaceMesh mesh_;
  Topology topology_;
  std::vector<std::uint32_t> component_;  // all 0: one disk
  std::vector<std::array<Complex, 3>> frames_;
  std::array<std::uint32_t, 2> anchors_{};
};

double NormaliseSurface(SurfaceMesh& mesh) {
  Eigen::Vector3d low = mesh.vertices[mesh.triangles[0][0]], high = low;
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t v : t) {
      low = low.cwiseMin(mesh.vertices[v]);
      high = high.cwiseMax(mesh.vertices[v]);
    }
  }
  const double diagonal = (high - low).norm();
  for (Eigen::Vector3d& p : mesh.vertices) p = (p - 0.5 * (low + high)) / diagonal;
  return diagonal;
}

bool AllFinite(const std::vector<Complex>& points) {
  return std::all_of(points.begin(), points.end(),
                     [](Complex p) { return std::isfinite(p.real()) && std::isfinite(p.imag()); });
}

}  // namespace

Result<Flattening> Flatten(SurfaceMesh mesh, const FlattenOptions& options,
                           const CancelToken& cancel) {
  if (options.refine < 0 || options.refine > kMaxFlattenRefine) {
    return Fail(
        Fault{FaultKind::kInvalidOption,
              fmt::format("refine is {}; it must be 0 to {}", options.refine, kMaxFlattenRefine),
              {},
              {{"limit", fmt::to_string(kMaxFlattenRefine)}},
              "refine"});
  }
  auto warnings = ValidateSurface(mesh, options.limits);
  if (!warnings) return Fail(std::move(warnings.error()));
  Topology topology = BuildTopology(mesh.vertices.size(), mesh.triangles);
  if (auto ok = CheckDisk(topology, mesh.vertices.size(), mesh.triangles.size()); !ok) {
    return Fail(std::move(ok.error()));
  }
  const double diagonal = NormaliseSurface(mesh);
  const Flattener flattener(std::move(mesh), std::move(topology));
  auto system = flattener.Cells(options.energy);
  if (!system) return Fail(std::move(system.error()));
  if (auto ok = cancel.Check(); !ok) return Fail(std::move(ok.error()));

  auto first = flattener.FirstStep(system->cells);
  if (!first) return Fail(std::move(first.error()));
  std::vector<Complex> uv = *first;
  if (auto ok = flattener.RigidSteps(system->cells, 1, cancel, uv); !ok) {
    return Fail(std::move(ok.error()));
  }
  if (options.refine > 0) {
    // FACE cells with cotangents descend the energy that is reported; EDGE cells need not.
    auto face = flattener.Cells({Basis::kFace, Weights::kCotangent, options.energy.rigidity});
    if (!face) return Fail(std::move(face.error()));
    if (auto ok = flattener.RigidSteps(face->cells, options.refine, cancel, uv); !ok) {
      return Fail(std::move(ok.error()));
    }
  }
  Flattening result;
  if (!AllFinite(*first) || !AllFinite(uv)) {
    return Fail(FaultKind::kNumerical, "the flat shape is not finite");
  }
  result.distortion = Measure(flattener.mesh(), uv, result.singular_values);
  for (Complex& p : *first) p *= diagonal;
  for (Complex& p : uv) p *= diagonal;
  result.first_step = std::move(*first);
  result.uv = std::move(uv);
  result.anchors = flattener.anchors();
  result.triangles = flattener.mesh().triangles;
  result.warnings = std::move(*warnings);
  if (system->clamped > 0) {
    result.warnings.push_back(
        {"clamped_weights",
         system->clamped,
         {},
         fmt::format(
             "{} edges have a cotangent weight too small or negative for this basis; it was "
             "raised",
             system->clamped)});
  }
  return result;
}

}  // namespace arap
