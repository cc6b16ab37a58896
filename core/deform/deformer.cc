#include "arap/core/deformer.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "core/base/try.h"
#include "core/deform/compiled_parts.h"
#include "core/deform/target_rows.h"
#include "core/deform/vertex_runs.h"
#include "core/energy/local_step.h"

namespace arap {
namespace {

// One set of targets on its way to a shape, step by step [algorithm §2]. The rigid solve itself is
// left to the caller, so that several frames can share one pass over the factor.
//
// Coordinates are normalised and relative to the mean target. Allocates at construction only.
// Nothing is kept from one set of targets to the next.
class Frame {
 public:
  explicit Frame(const CompiledHandlesParts& set);

  // Checks the targets and takes step 1. Faults: those of TargetRows::Place and of a
  // back-substitution.
  Status Begin(std::span<const Target> targets, SolverScratch& scratch);

  // The right-hand side of step 2 (#V) with the rotations of the shape so far. Without `turned`
  // every rotation is 1: the baseline of eq. 1, where the edges exert no force.
  void Force(bool turned, std::span<Complex> force);

  // The shape of step 2 from the solution of the rigid factor for that force (#V); empty for no
  // force. Fault: that of a back-substitution.
  Status Rigid(std::span<const Complex> solution, SolverScratch& scratch);

  // Writes the shape to `positions` (#V, units of the mesh) and measures it, or its handles alone.
  // kNumerical when anything is not finite; `positions` is scratch then.
  Result<ShapeQuality> Finish(std::span<const Target> targets, bool measured,
                              std::vector<Complex>& positions);

 private:
  bool IsActive(const VertexRun& run) const {
    return run.component != kNone && set_.roles.active_slot[run.component] != kNone;
  }
  void FitBase();
  void StartFromBase(bool rigid);
  bool Place(std::vector<Complex>& positions);
  void MeasureTriangles(const std::vector<Complex>& positions, ShapeQuality& quality) const;
  void MeasureHandles(std::span<const Target> targets, const std::vector<Complex>& positions,
                      ShapeQuality& quality) const;

  const CompiledHandlesParts& set_;
  const RegisteredMeshParts& mesh_;
  TargetRows targets_;
  std::vector<Complex> shape_;          // #V
  std::vector<Complex> miss_;           // per active row: target minus place
  std::vector<Similarity> base_;        // per component: the similarity that fits its targets best
  std::vector<double> counts_, sizes_;  // per component, of FitBase
  std::vector<Complex> mean_;           // per component: t̄, the rotation of the base
};

Frame::Frame(const CompiledHandlesParts& set)
    : set_(set),
      mesh_(set.mesh->parts()),
      targets_(set),
      shape_(mesh_.rest.size()),
      miss_(set.roles.active_rows.size()),
      base_(mesh_.components.size()),
      counts_(mesh_.components.size()),
      sizes_(mesh_.components.size()),
      mean_(mesh_.components.size(), 1) {}

Status Frame::Begin(std::span<const Target> targets, SolverScratch& scratch) {
  CHECK_OK(targets_.Place(targets));
  FitBase();
  StartFromBase(false);
  return set_.solver->AddSimilarity(miss_, shape_, scratch);
}

void Frame::Force(bool turned, std::span<Complex> force) {
  std::fill(force.begin(), force.end(), Complex(0));
  if (turned) {
    AddRotatedEdges(mesh_.cells, shape_, mean_, force);
  } else {
    std::fill(mean_.begin(), mean_.end(), Complex(1));
  }
  StartFromBase(true);
  set_.solver->CompleteForce(miss_, force);
}

Status Frame::Rigid(std::span<const Complex> solution, SolverScratch& scratch) {
  return set_.solver->AddRigid(solution, miss_, shape_, scratch);
}

Result<ShapeQuality> Frame::Finish(std::span<const Target> targets, bool measured,
                                   std::vector<Complex>& positions) {
  if (!Place(positions)) {
    return Fail(FaultKind::kNumerical,
                "The shape is not finite: the targets are too far away for this mesh.");
  }
  ShapeQuality quality;
  quality.measured = measured;
  if (measured) MeasureTriangles(positions, quality);
  MeasureHandles(targets, positions, quality);
  if (!std::isfinite(quality.energy) || !std::isfinite(quality.worst_handle_error) ||
      !std::isfinite(quality.mean_stretch)) {
    return Fail(FaultKind::kNumerical, "A measure of the shape is not finite.");
  }
  return quality;
}

// The similarity of each component that fits its targets best. It is in the null space of step 1,
// and its rotation in that of the turned edges of step 2; solving for the difference keeps rigid
// motions exact.
void Frame::FitBase() {
  for (Similarity& s : base_) s = {0, 0, 0};
  for (std::size_t c = 0; c < base_.size(); ++c) counts_[c] = sizes_[c] = 0;
  for (const std::size_t r : set_.roles.active_rows) {
    const std::uint32_t c = set_.rows[r].component;
    base_[c].from += set_.rows[r].rest;
    base_[c].place += targets_[r];
    counts_[c] += 1;
  }
  for (std::size_t c = 0; c < base_.size(); ++c) {
    if (counts_[c] == 0) continue;
    base_[c].from /= counts_[c];
    base_[c].place /= counts_[c];
  }
  for (const std::size_t r : set_.roles.active_rows) {
    const std::uint32_t c = set_.rows[r].component;
    const Complex arm = set_.rows[r].rest - base_[c].from;
    base_[c].turn += std::conj(arm) * (targets_[r] - base_[c].place);
    sizes_[c] += std::norm(arm);
  }
  for (std::size_t c = 0; c < base_.size(); ++c) {
    if (counts_[c] > 0) base_[c].turn /= sizes_[c];
    const double size = std::abs(base_[c].turn);
    mean_[c] = size > kNoDirection ? base_[c].turn / size : 1;
  }
}

// shape := the base, or its rigid part; miss := what the rows lack.
void Frame::StartFromBase(bool rigid) {
  for (const VertexRun& run : mesh_.runs) {
    const Similarity start = !IsActive(run) ? Similarity{0, 0, 1}
                             : rigid        ? Similarity{base_[run.component].from,
                                                  base_[run.component].place, mean_[run.component]}
                                            : base_[run.component];
    SetToSimilarity(run, mesh_.rest, start, shape_);
  }
  for (std::size_t i = 0; i < miss_.size(); ++i) {
    const std::size_t r = set_.roles.active_rows[i];
    miss_[i] = targets_[r] - PointOf(set_.rows[r], shape_);
  }
}

// Back to the units of the mesh, into `positions`. False when a number is not finite.
bool Frame::Place(std::vector<Complex>& positions) {
  const double unit = mesh_.report.diagonal;
  bool finite = true;
  for (const VertexRun& run : mesh_.runs) {
    if (IsActive(run)) {
      finite &= ToUnits(run, shape_, targets_.middle(), unit, mesh_.origin, positions);
      continue;
    }
    const Complex shift = run.component == kNone ? 0 : unit * targets_.shift(run.component);
    for (std::size_t v = run.begin; v < run.end; ++v) {
      positions[v] = mesh_.mesh.vertices[v];
      if (run.component != kNone) positions[v] += shift;
      finite &= std::isfinite(positions[v].real()) && std::isfinite(positions[v].imag());
    }
  }
  // A vertex that stands for others is the lowest of them.
  const std::vector<std::uint32_t>& standing = mesh_.repair.vertex;
  for (std::size_t v = 0; v < standing.size(); ++v) positions[v] = positions[standing[v]];
  return finite;
}

void Frame::MeasureTriangles(const std::vector<Complex>& positions, ShapeQuality& quality) const {
  const auto stretch = mesh_.stretch.Measure(mesh_.mesh, positions, mesh_.report.diagonal);
  quality.flipped = stretch.flipped;
  quality.mean_stretch = stretch.mean;
  quality.max_stretch = stretch.max;
  quality.energy = RigidEnergy(mesh_.cells, shape_);
}

void Frame::MeasureHandles(std::span<const Target> given, const std::vector<Complex>& positions,
                           ShapeQuality& quality) const {
  for (const Row& row : set_.rows) {
    Complex p = 0;
    for (std::size_t k = 0; k < 3; ++k) p += row.weight[k] * positions[row.vertex[k]];
    const Complex wanted =
        given[row.handle].position + targets_.OffsetOf(row) * mesh_.report.diagonal;
    const double error = std::abs(p - wanted);
    if (error > quality.worst_handle_error) {
      quality.worst_handle_error = error;
      quality.worst_handle = row.handle;
    }
  }
}

Status CheckOptions(const DeformOptions& options) {
  if (options.refine < 0 || options.refine > kMaxRefine) {
    return Fail(
        Fault(FaultKind::kInvalidOption,
              fmt::format("options.refine is {}; it must be 0 to {}.", options.refine, kMaxRefine))
            .Field("options.refine")
            .Detail("value", options.refine)
            .Detail("limit", kMaxRefine));
  }
  return {};
}

// How often step 2 is taken.
int RigidSteps(const DeformOptions& options) {
  switch (options.mode) {
    case DeformMode::kRigid:
      return 1 + options.refine;
    case DeformMode::kBaseline:
      return 1;
    case DeformMode::kSimilarity:
      return 0;
  }
  return 0;
}

}  // namespace

// `lanes` frames side by side: their right-hand sides go through the factor together.
class Deformer::Scratch {
 public:
  Scratch(std::shared_ptr<const CompiledHandles> compiled, std::size_t lanes)
      : handles(std::move(compiled)), set_(handles->parts()) {
    const auto& vertices = set_.mesh->mesh().vertices;
    for (std::size_t i = 0; i < lanes; ++i) {
      frames_.emplace_back(set_);
      positions.emplace_back(vertices);
      next_.emplace_back(vertices.size());
    }
    force_.resize(vertices.size() * lanes);
    set_.solver->Prepare(solver_);
  }

  // Fills qualities[i] and positions[i] for every given[i], frame `first` + i of a track; at most
  // `lanes` of them. The first fault ends it and leaves all positions alone.
  Status Update(std::span<const std::span<const Target>> given, const DeformOptions& options,
                std::span<ShapeQuality> qualities, const CancelToken& cancel, std::size_t first) {
    CHECK_OK(CheckOptions(options));
    for (std::size_t i = 0; i < given.size(); ++i) CHECK_OK(frames_[i].Begin(given[i], solver_));
    const bool turned = options.mode == DeformMode::kRigid;
    for (int step = 0; step < RigidSteps(options); ++step) {
      CHECK_OK(cancel.Check());
      CHECK_OK(RigidStep(turned, given.size()));
    }
    for (std::size_t i = 0; i < given.size(); ++i) {
      const bool measured = options.measure_every > 0 && (first + i) % options.measure_every == 0;
      TRY(qualities[i], frames_[i].Finish(given[i], measured, next_[i]));
    }
    for (std::size_t i = 0; i < given.size(); ++i) positions[i].swap(next_[i]);
    return {};
  }

  std::shared_ptr<const CompiledHandles> handles;
  std::vector<std::vector<Complex>> positions;  // per lane, of the last good update

 private:
  Status RigidStep(bool turned, std::size_t count) {
    const std::size_t size = set_.mesh->mesh().vertices.size();
    for (std::size_t i = 0; i < count; ++i) {
      frames_[i].Force(turned, std::span(force_).subspan(i * size, size));
    }
    std::span<const Complex> solution;
    if (set_.solver->NeedsRigidSolve(turned)) {
      solution = set_.solver->rigid_factor().SolvePoints(std::span(force_).first(count * size),
                                                         count, solver_.workspace);
    }
    for (std::size_t i = 0; i < count; ++i) {
      const bool solved = !solution.empty();
      CHECK_OK(frames_[i].Rigid(solved ? solution.subspan(i * size, size) : solution, solver_));
    }
    return {};
  }

  const CompiledHandlesParts& set_;
  std::vector<Frame> frames_;
  std::vector<std::vector<Complex>> next_;  // until all is known to be finite
  std::vector<Complex> force_;              // #V per lane
  SolverScratch solver_;
};

Deformer::Deformer(std::shared_ptr<const CompiledHandles> handles, std::size_t lanes)
    : scratch_(std::make_unique<Scratch>(std::move(handles), lanes)) {}
Deformer::~Deformer() = default;
Deformer::Deformer(Deformer&&) noexcept = default;
Deformer& Deformer::operator=(Deformer&&) noexcept = default;

Result<ShapeQuality> Deformer::Update(std::span<const Target> targets, const DeformOptions& options,
                                      const CancelToken& cancel) {
  ShapeQuality quality;
  CHECK_OK(scratch_->Update({&targets, 1}, options, {&quality, 1}, cancel, 0));
  return quality;
}

Status Deformer::UpdateMany(std::span<const std::span<const Target>> frames,
                            const DeformOptions& options, std::span<ShapeQuality> qualities,
                            const CancelToken& cancel, std::size_t first) {
  if (frames.size() > lanes() || qualities.size() < frames.size()) {
    return Fail(FaultKind::kInternal,
                fmt::format("There are {} frames for {} lanes.", frames.size(), lanes()));
  }
  return scratch_->Update(frames, options, qualities, cancel, first);
}

std::size_t Deformer::lanes() const { return scratch_->positions.size(); }

std::span<const Complex> Deformer::positions(std::size_t lane) const {
  return scratch_->positions[lane];
}

std::vector<std::uint32_t> Deformer::FlippedTriangles(std::size_t lane) const {
  std::vector<std::uint32_t> flipped;
  const RegisteredMeshParts& mesh = scratch_->handles->mesh()->parts();
  for (std::uint32_t t = 0; t < mesh.mesh.triangles.size(); ++t) {
    if (!IsFlipped(mesh.mesh.triangles[t], scratch_->positions[lane])) continue;
    // Parts of one triangle come after one another.
    const std::uint32_t given = mesh.repair.TriangleOf(t);
    if (flipped.empty() || flipped.back() != given) flipped.push_back(given);
  }
  return flipped;
}

const std::shared_ptr<const CompiledHandles>& Deformer::handles() const {
  return scratch_->handles;
}

}  // namespace arap
