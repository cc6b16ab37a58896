#include "core/flatten/chart_layout.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <utility>

#include "core/base/plane.h"
#include "core/base/try.h"
#include "core/flatten/abf/abf.h"
#include "core/flatten/distortion.h"
#include "core/flatten/injective/injective.h"
#include "core/flatten/layout/first_step.h"
#include "core/flatten/layout/held.h"
#include "core/flatten/layout/local_global.h"

namespace arap {
namespace {

// How well the free first step must have settled, as a part of the distortion: as a start for the
// second it need not be exact.
constexpr double kRoughly = 1e-2;
constexpr double kExactly = 1e-5;

// One flip in so many triangles is soon mended by refining; more are a fold.
constexpr std::size_t kFew = 1000;

bool AllFinite(const std::vector<Complex>& points) {
  return std::all_of(points.begin(), points.end(), IsFinite);
}

bool IsFaceCotangent(const EnergyOptions& energy) {
  return energy.basis == Basis::kFace && energy.weights == Weights::kCotangent;
}

class LayoutSteps {
 public:
  LayoutSteps(const Chart& chart, const FlattenOptions& options, const EnergyOptions& energy,
              PinSolver solver, const std::string& name, FactorCache& cache,
              const CancelToken& cancel)
      : chart_(chart),
        options_(options),
        energy_(energy),
        solver_(solver),
        cancel_(cancel),
        centre_(chart.centre),
        factors_(name, n(), options.method, energy, cache) {}

  Result<ChartLayout> Run(const Wishes& wishes) {
    Hold(wishes);
    CHECK_OK(MakeCells());
    CHECK_OK(FirstStep());
    CHECK_OK(cancel_.Check());
    CHECK_OK(RigidSteps());
    if (options_.injective) CHECK_OK(MakeInjective());
    if (!AllFinite(layout_.first_step) || !AllFinite(layout_.uv)) {
      return Fail(FaultKind::kNumerical, "The flat shape is not finite.");
    }
    Place(wishes);
    layout_.factor_times = factors_.times();
    layout_.factor_times.analysis += injective_times_.analysis;
    layout_.factor_times.numbers += injective_times_.numbers;
    return std::move(layout_);
  }

 private:
  std::size_t n() const { return chart_.mesh.vertices.size(); }

  // Pins where there are several; else the anchors that were asked for. Pins are solved for on the
  // factor of the anchors, so that a layout without pins and layouts with any share it.
  void Hold(const Wishes& wishes) {
    if (wishes.pinned()) {
      for (const HeldVertex& pin : wishes.pins) origin_ += pin.uv;
      origin_ /= static_cast<double>(wishes.pins.size());
      for (HeldVertex pin : wishes.pins) {
        pin.uv = (pin.uv - origin_) / chart_.diagonal;
        held_.vertices.push_back(pin);
      }
      pins_ = true;
      null_space_ = solver_ == PinSolver::kNullSpace ||
                    (solver_ == PinSolver::kAuto && wishes.pins.size() <= kDirectPins);
    } else if (options_.anchors != FlattenAnchors::kSpectral) {
      const auto anchors = Anchors();
      held_ = HoldAtDistance(chart_, anchors);
      layout_.anchors = {anchors[0], anchors[1]};
    }
  }

  std::array<std::uint32_t, 2> Anchors() const {
    return options_.anchors == FlattenAnchors::kFarBoundary ? FarBoundaryPair(chart_) : centre_;
  }

  Status MakeCells() {
    TRY(auto system,
        options_.method == FlattenMethod::kAbf ? CellsOfFlatAngles() : chart_.Cells(energy_));
    cells_ = std::move(system.cells);
    layout_.clamped = system.clamped;
    return {};
  }

  // Triangles of the angles that angle-based flattening finds.
  Result<CellSystem> CellsOfFlatAngles() {
    TRY(const auto angles,
        FlatAngles(chart_.mesh, chart_.topology, cancel_, kMaxAngleSteps, chart_.left_out));
    std::vector<std::array<Complex, 3>> frames;
    frames.reserve(angles.size());
    for (std::uint32_t t = 0; t < angles.size(); ++t) {
      const bool left_out = !chart_.left_out.empty() && chart_.left_out[t];
      const auto own = chart_.Frame(t);
      frames.push_back(left_out ? own : FrameOfAngles(angles[t], own[1].real()));
    }
    return chart_.Cells({Basis::kFace, Weights::kCotangent, energy_.rigidity}, frames);
  }

  Status FirstStep() {
    if (null_space_) {
      TRY(const bool done, PinnedStep());
      if (done) return {};
      if (solver_ == PinSolver::kNullSpace) {
        return Fail(FaultKind::kNumerical, "Two vertices are too small a hold on this surface.");
      }
      null_space_ = false;
    }
    if (held_.empty()) {
      TRY(const auto system, factors_.Free(cells_, DropCells()));
      const double accuracy = options_.method == FlattenMethod::kArap ? kRoughly : kExactly;
      TRY(auto first, SpectralFirstStep(*system, chart_, centre_, accuracy, cancel_));
      SetFirstStep(std::move(first));
      return {};
    }
    TRY(const auto system, factors_.Holding(cells_, held_, DropCells()));
    TRY(auto first, HeldFirstStep(*system, held_, n()));
    SetFirstStep(std::move(first));
    if (!pins_ && options_.method == FlattenMethod::kArap && options_.refine > 0) {
      return Unfold(*system);
    }
    return {};
  }

  // Lets the cells of the first step go where no other step has the same.
  std::function<void()> DropCells() {
    if (options_.method == FlattenMethod::kArap) return {};
    return [this] { cells_ = {}; };
  }

  // Refining starts from the shape without anchors where they fold the surface and it has fewer
  // flips.
  Status Unfold(const GroundedSystem<Complex>& system) {
    const std::size_t folded = Flips(layout_.uv);
    if (folded * kFew <= chart_.mesh.triangles.size() || system.lifted()) return {};
    TRY(auto loose,
        LoosenedFirstStep(system, cells_, chart_, Anchors(), layout_.first_step, cancel_));
    if (AllFinite(loose) && Flips(loose) < folded) layout_.uv = std::move(loose);
    return {};
  }

  std::size_t Flips(const std::vector<Complex>& uv) const {
    return NotUpright(chart_.mesh.triangles, uv, chart_.left_out).size();
  }

  // The first step from the factor of the anchors; false when that is not exact enough.
  Result<bool> PinnedStep() {
    const auto ground = Anchors();
    const auto system = factors_.Holding(cells_, {{{ground[0], 0, 0}, {ground[1], 0, 0}}});
    if (!system || (*system)->lifted()) return false;
    TRY(auto first, PinnedFirstStep(**system, ground, cells_, held_, n(), cancel_));
    if (!first) return false;
    SetFirstStep(*std::move(first));
    return true;
  }

  void SetFirstStep(std::vector<Complex> shape) {
    layout_.first_step = std::move(shape);
    layout_.uv = layout_.first_step;
  }

  // The second step and what refines it. Anchors have done their work: the rigid step needs one
  // vertex held, or the pins.
  Status RigidSteps() {
    const bool second = options_.method == FlattenMethod::kArap;
    // The second step of FACE cells with cotangents is the first refinement.
    const bool merged = second && IsFaceCotangent(energy_);
    if (second && !merged) {
      if (auto taken = Take({1, false, 0}, false); !taken) return Fail(std::move(taken).error());
    }
    const int steps = options_.refine + (merged ? 1 : 0);
    if (steps == 0) return {};
    if (!merged) {
      TRY(auto face, chart_.Cells({Basis::kFace, Weights::kCotangent, energy_.rigidity}));
      cells_ = std::move(face.cells);
    }
    const double stop = options_.refine > 0 ? options_.refine_stop : 0;
    TRY(const auto refined, Take({steps, options_.refine > 0, stop}, true));
    layout_.refinements = std::max(0, refined.taken - (merged ? 1 : 0));
    if (options_.refine > 0) {
      layout_.refine_end = refined.converged ? RefineEnd::kConverged : RefineEnd::kLimit;
    }
    return {};
  }

  Result<LocalGlobalResult> Take(const LocalGlobalOptions& steps, bool refining) {
    const Held none;
    const Held& held = pins_ ? held_ : none;
    // With the null space one vertex is grounded, as without pins.
    const Held& factored = null_space_ ? none : held;
    TRY(auto factor, factors_.Rigid(cells_, factored, centre_[0], refining));
    std::unique_ptr<const RigidSolver> solver;
    if (null_space_) {
      TRY(solver, PinnedRigidSolver(std::move(factor), centre_[0], held, cancel_));
    } else {
      solver = FactoredRigidSolver(std::move(factor), held);
    }
    return LocalGlobal(cells_, held, *solver, steps, cancel_, layout_.uv);
  }

  Status MakeInjective() {
    if (IsInjective()) return {};
    InjectiveOptions options;
    options.left_out = chart_.left_out;
    if (pins_) {
      for (const HeldVertex& h : held_.vertices) {
        options.pins.push_back(
            {h.vertex, h.uv, h.weight > 0 ? h.weight : std::numeric_limits<double>::infinity()});
      }
    }
    TRY(auto layout, FlattenInjective(chart_.mesh, chart_.loops, layout_.uv, options, cancel_));
    layout_.uv = std::move(layout.uv);
    injective_times_ = layout.times;
    return {};
  }

  bool IsInjective() const {
    std::vector<bool> boundary(n());
    for (const auto& loop : chart_.loops) {
      for (const std::uint32_t v : loop) boundary[v] = true;
    }
    return LocallyInjective(chart_.mesh.triangles, layout_.uv, boundary, chart_.left_out);
  }

  // Into the units of the input, and to where a grain line and a single pin want it.
  void Place(const Wishes& wishes) {
    Complex turn = 1;
    if (wishes.grain) {
      const Complex along = layout_.uv[wishes.grain->to] - layout_.uv[wishes.grain->from];
      turn = std::polar(1.0, wishes.grain->angle - std::arg(along));
    }
    Complex shift = origin_;
    if (wishes.pins.size() == 1) {
      const HeldVertex& pin = wishes.pins.front();
      shift = pin.uv - turn * layout_.uv[pin.vertex] * chart_.diagonal;
    }
    for (auto* points : {&layout_.first_step, &layout_.uv}) {
      for (Complex& p : *points) p = turn * p * chart_.diagonal + shift;
    }
    // Exactly, not up to the rounding of two changes of the unit.
    for (const HeldVertex& pin : wishes.pins) {
      if (pin.weight == 0 || wishes.pins.size() == 1) layout_.uv[pin.vertex] = pin.uv;
    }
  }

  const Chart& chart_;
  const FlattenOptions& options_;
  const EnergyOptions& energy_;
  const PinSolver solver_;
  const CancelToken& cancel_;
  const std::array<std::uint32_t, 2> centre_;
  ChartFactors factors_;
  Held held_;
  bool pins_ = false;
  bool null_space_ = false;  // pins are solved for on factors that have none
  Complex origin_ = 0;
  Cells cells_;
  ChartLayout layout_;
  FactorTimes injective_times_;
};

}  // namespace

Result<ChartLayout> LayOutChart(const Chart& chart, const FlattenOptions& options,
                                const EnergyOptions& energy, PinSolver solver, const Wishes& wishes,
                                const std::string& name, FactorCache& cache,
                                const CancelToken& cancel) {
  return LayoutSteps(chart, options, energy, solver, name, cache, cancel).Run(wishes);
}

}  // namespace arap
