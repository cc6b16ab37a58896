#include "core/deform/frame.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/base/try.h"
#include "core/energy/local_step.h"

namespace arap {

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

void Frame::Force(bool turned, std::span<Complex> force, std::vector<double>& room) {
  std::fill(force.begin(), force.end(), Complex(0));
  if (turned) {
    AddRotatedEdges(mesh_.cells, shape_, mean_, force, crew_, room);
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
  RunRanges(crew_, shape_.size(), kVertexRange, [&](std::size_t begin, std::size_t end) {
    ForRunsIn(mesh_.runs, begin, end, [&](const VertexRun& run) {
      Similarity start{0, 0, 1};
      if (IsActive(run)) {
        start = base_[run.component];
        if (rigid) start.turn = mean_[run.component];
      }
      SetToSimilarity(run, mesh_.rest, start, shape_);
    });
  });
  for (std::size_t i = 0; i < miss_.size(); ++i) {
    const std::size_t r = set_.roles.active_rows[i];
    miss_[i] = targets_[r] - PointOf(set_.rows[r], shape_);
  }
}

// Back to the units of the mesh, into `positions`. False when a number is not finite.
bool Frame::Place(std::vector<Complex>& positions) {
  const double unit = mesh_.report.diagonal;
  std::atomic<bool> strange = false;
  RunRanges(crew_, shape_.size(), kVertexRange, [&](std::size_t begin, std::size_t end) {
    bool finite = true;
    ForRunsIn(mesh_.runs, begin, end, [&](const VertexRun& run) {
      if (IsActive(run)) {
        finite &= ToUnits(run, shape_, targets_.middle(), unit, mesh_.origin, positions);
        return;
      }
      const Complex shift = run.component == kNone ? 0 : unit * targets_.shift(run.component);
      for (std::size_t v = run.begin; v < run.end; ++v) {
        positions[v] = mesh_.mesh.vertices[v];
        if (run.component != kNone) positions[v] += shift;
        finite &= std::isfinite(positions[v].real()) && std::isfinite(positions[v].imag());
      }
    });
    if (!finite) strange = true;
  });
  // A vertex that stands for others is the lowest of them.
  const std::vector<std::uint32_t>& standing = mesh_.repair.vertex;
  for (std::size_t v = 0; v < standing.size(); ++v) positions[v] = positions[standing[v]];
  return !strange;
}

void Frame::MeasureTriangles(const std::vector<Complex>& positions, ShapeQuality& quality) const {
  const auto stretch = mesh_.stretch.Measure(mesh_.mesh, positions, mesh_.report.diagonal, crew_);
  quality.flipped = stretch.flipped;
  quality.mean_stretch = stretch.mean;
  quality.max_stretch = stretch.max;
  quality.energy = RigidEnergy(mesh_.cells, shape_, crew_);
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

}  // namespace arap
