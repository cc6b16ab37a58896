#include "arap/core/deformer.h"

#include <array>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

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

// From so many bytes on one pass for two frames saves a tenth of their time; a smaller factor is
// still near the processor when it is read again. docs/performance.md §2 has what was measured.
constexpr std::size_t kSharedFactorBytes = 8'000'000;

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
                std::span<ShapeQuality> qualities, const CancelToken& cancel, std::size_t first,
                Crew* crew) {
    CHECK_OK(Begin(given, options, crew));
    const bool turned = options.mode == DeformMode::kRigid;
    for (int step = 0; step < RigidSteps(options); ++step) {
      CHECK_OK(cancel.Check());
      Force(turned, given.size());
      const bool solves = NeedsSolve(turned);
      CHECK_OK(Rigid(solves ? Solve(given.size()) : std::span<const Complex>(), given.size()));
    }
    return Finish(given, options, first, qualities);
  }

  // The parts of Update, of which UpdateTogether takes those of two.

  Status Begin(std::span<const std::span<const Target>> given, const DeformOptions& options,
               Crew* crew) {
    CHECK_OK(CheckOptions(options));
    solver_.crew = crew;
    for (Frame& frame : frames_) frame.Use(crew);
    for (std::size_t i = 0; i < given.size(); ++i) CHECK_OK(frames_[i].Begin(given[i], solver_));
    return {};
  }
  void Force(bool turned, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      frames_[i].Force(turned, std::span(force_).subspan(i * size(), size()), pulls_);
    }
  }
  const Factor<double>& factor() const { return set_.solver->rigid_factor(); }
  bool NeedsSolve(bool turned) const { return set_.solver->NeedsRigidSolve(turned); }
  std::span<const Complex> Solve(std::size_t count) {
    return factor().SolvePoints(std::span(force_).first(count * size()), count, solver_.workspace,
                                solver_.crew);
  }
  // The same for lane 0 of two, which have one factor.
  static std::pair<std::span<const Complex>, std::span<const Complex>> SolveBoth(Scratch& one,
                                                                                 Scratch& other) {
    return one.factor().SolveBoth(one.force_, one.solver_.workspace, other.force_,
                                  other.solver_.workspace, one.solver_.crew);
  }
  // `solution` is empty where nothing was to be solved.
  Status Rigid(std::span<const Complex> solution, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      const bool solved = !solution.empty();
      CHECK_OK(frames_[i].Rigid(solved ? solution.subspan(i * size(), size()) : solution, solver_));
    }
    return {};
  }
  Status Finish(std::span<const std::span<const Target>> given, const DeformOptions& options,
                std::size_t first, std::span<ShapeQuality> qualities) {
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
  std::size_t size() const { return set_.mesh->mesh().vertices.size(); }

  const CompiledHandlesParts& set_;
  std::vector<Frame> frames_;
  std::vector<std::vector<Complex>> next_;  // until all is known to be finite
  std::vector<Complex> force_;              // #V per lane
  std::vector<double> pulls_;               // with a crew only: forces that are not added yet
  SolverScratch solver_;
};

Deformer::Deformer(std::shared_ptr<const CompiledHandles> handles, std::size_t lanes)
    : scratch_(std::make_unique<Scratch>(std::move(handles), lanes)) {}
Deformer::~Deformer() = default;
Deformer::Deformer(Deformer&&) noexcept = default;
Deformer& Deformer::operator=(Deformer&&) noexcept = default;

Result<ShapeQuality> Deformer::Update(std::span<const Target> targets, const DeformOptions& options,
                                      const CancelToken& cancel, Crew* crew) {
  ShapeQuality quality;
  CHECK_OK(scratch_->Update({&targets, 1}, options, {&quality, 1}, cancel, 0, crew));
  return quality;
}

Status Deformer::UpdateMany(std::span<const std::span<const Target>> frames,
                            const DeformOptions& options, std::span<ShapeQuality> qualities,
                            const CancelToken& cancel, std::size_t first, Crew* crew) {
  if (frames.size() > lanes() || qualities.size() < frames.size()) {
    return Fail(FaultKind::kInternal,
                fmt::format("There are {} frames for {} lanes.", frames.size(), lanes()));
  }
  return scratch_->Update(frames, options, qualities, cancel, first, crew);
}

const void* SharedFactor(const CompiledHandles& handles) {
  const Factor<double>& factor = handles.parts().solver->rigid_factor();
  return factor.bytes() > kSharedFactorBytes ? &factor : nullptr;
}

void UpdateTogether(JointFrame& one, JointFrame& other, Crew* crew) {
  struct Half {
    JointFrame& frame;
    Deformer::Scratch& scratch;
    bool turned = false;
    Status status{};
    bool steps = false;   // takes this step
    bool solves = false;  // and a pass over the factor in it
    std::span<const Complex> solution{};
  };
  std::array<Half, 2> halves{Half{one, *one.deformer.scratch_},
                             Half{other, *other.deformer.scratch_}};
  auto& [first, second] = halves;
  const bool shared = &first.scratch.factor() == &second.scratch.factor();
  for (Half& half : halves) {
    half.turned = half.frame.options.mode == DeformMode::kRigid;
    half.status = half.scratch.Begin({&half.frame.targets, 1}, half.frame.options, crew);
  }
  for (int step = 0;; ++step) {
    for (Half& half : halves) {
      half.steps = half.status && step < RigidSteps(half.frame.options);
      if (half.steps) half.status = half.frame.cancel.Check();
      half.steps = half.steps && half.status;
      half.solves = half.steps && half.scratch.NeedsSolve(half.turned);
      if (half.steps) half.scratch.Force(half.turned, 1);
    }
    if (!first.steps && !second.steps) break;
    if (shared && first.solves && second.solves) {
      std::tie(first.solution, second.solution) =
          Deformer::Scratch::SolveBoth(first.scratch, second.scratch);
    } else {
      for (Half& half : halves) {
        half.solution = half.solves ? half.scratch.Solve(1) : std::span<const Complex>();
      }
    }
    for (Half& half : halves) {
      if (half.steps) half.status = half.scratch.Rigid(half.solution, 1);
    }
  }
  for (Half& half : halves) {
    ShapeQuality quality;
    if (half.status)
      half.status =
          half.scratch.Finish({&half.frame.targets, 1}, half.frame.options, 0, {&quality, 1});
    half.frame.quality = quality;
    if (!half.status) half.frame.quality = Fail(std::move(half.status).error());
  }
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
