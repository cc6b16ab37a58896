#include "arap/core/deformer.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/base/try.h"
#include "core/deform/compiled_parts.h"
#include "core/deform/frame.h"

namespace arap {
namespace {

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
    force_.resize(2 * vertices.size() * lanes);
    set_.solver->Prepare(solver_);
  }

  // Fills qualities[i] and positions[i] for every given[i]; at most `lanes` of them. The first
  // fault ends it and leaves all positions alone.
  Status Update(std::span<const std::span<const Target>> given, const DeformOptions& options,
                std::span<ShapeQuality> qualities, const CancelToken& cancel) {
    CHECK_OK(CheckOptions(options));
    for (std::size_t i = 0; i < given.size(); ++i) CHECK_OK(frames_[i].Begin(given[i], solver_));
    const bool turned = options.mode == DeformMode::kRigid;
    for (int step = 0; step < RigidSteps(options); ++step) {
      CHECK_OK(cancel.Check());
      CHECK_OK(RigidStep(turned, given.size()));
    }
    for (std::size_t i = 0; i < given.size(); ++i) {
      TRY(qualities[i], frames_[i].Finish(given[i], next_[i]));
    }
    for (std::size_t i = 0; i < given.size(); ++i) positions[i].swap(next_[i]);
    return {};
  }

  std::shared_ptr<const CompiledHandles> handles;
  std::vector<std::vector<Complex>> positions;  // per lane, of the last good update

 private:
  Status RigidStep(bool turned, std::size_t count) {
    const std::size_t size = 2 * set_.mesh->mesh().vertices.size();
    for (std::size_t i = 0; i < count; ++i) {
      frames_[i].Force(turned, std::span(force_).subspan(i * size, size));
    }
    const double* solution = nullptr;
    if (set_.solver->NeedsRigidSolve(turned)) {
      TRY(const auto all, set_.solver->rigid_factor().Solve(std::span(force_).first(count * size),
                                                            2 * count, solver_.workspace));
      solution = all.data();
    }
    for (std::size_t i = 0; i < count; ++i) {
      CHECK_OK(frames_[i].Rigid(solution ? solution + i * size : nullptr, solver_));
    }
    return {};
  }

  const CompiledHandlesParts& set_;
  std::vector<Frame> frames_;
  std::vector<std::vector<Complex>> next_;  // until all is known to be finite
  std::vector<double> force_;
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
  CHECK_OK(scratch_->Update({&targets, 1}, options, {&quality, 1}, cancel));
  return quality;
}

Status Deformer::UpdateMany(std::span<const std::span<const Target>> frames,
                            const DeformOptions& options, std::span<ShapeQuality> qualities,
                            const CancelToken& cancel) {
  if (frames.size() > lanes() || qualities.size() < frames.size()) {
    return Fail(FaultKind::kInternal,
                fmt::format("There are {} frames for {} lanes.", frames.size(), lanes()));
  }
  return scratch_->Update(frames, options, qualities, cancel);
}

std::size_t Deformer::lanes() const { return scratch_->positions.size(); }

std::span<const Complex> Deformer::positions(std::size_t lane) const {
  return scratch_->positions[lane];
}

std::vector<std::uint32_t> Deformer::FlippedTriangles(std::size_t lane) const {
  std::vector<std::uint32_t> flipped;
  const auto& triangles = scratch_->handles->mesh()->mesh().triangles;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    if (IsFlipped(triangles[t], scratch_->positions[lane])) flipped.push_back(t);
  }
  return flipped;
}

const std::shared_ptr<const CompiledHandles>& Deformer::handles() const {
  return scratch_->handles;
}

}  // namespace arap
