#include "core/flatten/flatten_chart.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/base/timer.h"
#include "core/flatten/abf/abf.h"
#include "core/flatten/injective/injective.h"
#include "core/flatten/layout/anchors.h"
#include "core/flatten/layout/first_step.h"
#include "core/flatten/layout/local_global.h"
#include "core/flatten/layout/pinned_first_step.h"
#include "core/flatten/sheet/upright.h"

namespace arap {
namespace {

// How well the free first step must have settled, as a part of the distortion: as a start for the
// second it need not be exact.
constexpr double kRoughly = 1e-2;
constexpr double kExactly = 1e-5;

bool AllFinite(const std::vector<Complex>& points) {
  return std::all_of(points.begin(), points.end(),
                     [](Complex p) { return std::isfinite(p.real()) && std::isfinite(p.imag()); });
}

bool IsFaceCotangent(const EnergyOptions& energy) {
  return energy.basis == Basis::kFace && energy.weights == Weights::kCotangent;
}

class ChartFlattener {
 public:
  ChartFlattener(const SurfaceChart& chart, const FlattenOptions& options,
                 const EnergyOptions& energy, PinSolver solver, const std::string& name,
                 FactorCache& factors, const CancelToken& cancel)
      : chart_(chart),
        options_(options),
        energy_(energy),
        solver_(solver),
        name_(name),
        factors_(factors),
        cancel_(cancel),
        centre_(CentreEdge(chart)) {}

  Result<ChartLayout> Flatten(const ChartWishes& wishes) {
    Hold(wishes);
    if (auto ok = MakeCells(); !ok) return Fail(std::move(ok.error()));
    if (auto ok = FirstStep(); !ok) return Fail(std::move(ok.error()));
    if (auto ok = cancel_.Check(); !ok) return Fail(std::move(ok.error()));
    if (auto ok = RigidSteps(); !ok) return Fail(std::move(ok.error()));
    if (options_.injective) {
      if (auto ok = MakeInjective(); !ok) return Fail(std::move(ok.error()));
    }
    if (!AllFinite(layout_.first_step) || !AllFinite(layout_.uv)) {
      return Fail(FaultKind::kNumerical, "the flat shape is not finite");
    }
    Place(wishes);
    return std::move(layout_);
  }

 private:
  std::size_t n() const { return chart_.mesh.vertices.size(); }

  // Pins where there are several; else the anchors that were asked for. Pins are solved for on the
  // factor of the anchors, so that a layout without pins and layouts with any share it.
  void Hold(const ChartWishes& wishes) {
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
    Result<CellSystem> system = [&]() -> Result<CellSystem> {
      if (options_.method != FlattenMethod::kAbf) return chart_.Cells(energy_);
      auto angles =
          FlatAngles(chart_.mesh, chart_.topology, cancel_, kMaxAngleSteps, chart_.left_out);
      if (!angles) return Fail(std::move(angles.error()));
      std::vector<std::array<Complex, 3>> frames;
      frames.reserve(angles->size());
      for (std::size_t t = 0; t < angles->size(); ++t) {
        const bool left_out = !chart_.left_out.empty() && chart_.left_out[t];
        frames.push_back(left_out ? chart_.frames[t]
                                  : FrameOfAngles((*angles)[t], chart_.frames[t][1].real()));
      }
      return chart_.Cells({Basis::kFace, Weights::kCotangent, energy_.rigidity}, frames);
    }();
    if (!system) return Fail(std::move(system.error()));
    cells_ = std::move(system->cells);
    layout_.clamped = system->clamped;
    return {};
  }

  // Of the cells of the first step; angle-based flattening is laid out with FACE cells.
  Basis CellBasis() const {
    return options_.method == FlattenMethod::kAbf ? Basis::kFace : energy_.basis;
  }

  // What a factor of the first step depends on; empty when that cannot be said in a few words.
  std::string FirstKey(const char* step, const Held& held) const {
    if (!energy_.rigidity.empty()) return {};
    return fmt::format("{}/{}/{}/{}/{}{}", name_, step, options_.method == FlattenMethod::kAbf,
                       static_cast<int>(energy_.basis), static_cast<int>(energy_.weights),
                       Names(held));
  }

  // The same for the rigid step, whose order is that of the first. The matrix of a refinement is
  // the same whatever the energy of the steps before.
  std::string RigidKey(const Held& held, bool face) const {
    if (!energy_.rigidity.empty()) return {};
    const int basis = static_cast<int>(CellBasis());
    const std::string step =
        face ? "refine" : fmt::format("rigid/{}", static_cast<int>(energy_.weights));
    return fmt::format("{}/{}/{}{}", name_, step, basis, Names(held));
  }

  static std::string Names(const Held& held) {
    std::string names;
    for (const HeldVertex& h : held.vertices) names += fmt::format("/{}:{}", h.vertex, h.weight);
    return names;
  }

  template <class Scalar>
  Result<GroundedSystem<Scalar>> Timed(Result<GroundedSystem<Scalar>> made) {
    if (!made) return made;
    const FactorTimes& times = made->factor().times();
    layout_.factor_times.analysis += times.analysis;
    layout_.factor_times.numbers += times.numbers;
    return made;
  }

  // One order for all that is factored of a basis, whatever is held and however it is weighted.
  // Rounding follows the order: it must not depend on what was factored first.
  Result<Order> OrderOf(const Eigen::SparseMatrix<Complex>& lower) {
    const std::string key = fmt::format("{}/{}", name_, static_cast<int>(CellBasis()));
    return factors_.GetOrder(key, [&] {
      Stopwatch watch;
      auto order = EliminationOrder(lower);
      layout_.factor_times.analysis += watch.Lap();
      return order;
    });
  }

  Status FirstStep() {
    if (null_space_) {
      auto done = PinnedStep();
      if (!done) return Fail(std::move(done.error()));
      if (*done) return {};
      if (solver_ == PinSolver::kNullSpace) {
        return Fail(FaultKind::kNumerical, "two vertices are too small a hold on this surface");
      }
      null_space_ = false;
    }
    const bool spectral = held_.empty();
    auto system = spectral ? FreeSystem() : SystemHolding(held_);
    if (!system) return Fail(std::move(system.error()));
    order_ = (*system)->order();
    auto first =
        spectral ? SpectralFirstStep(**system, chart_, centre_,
                                     options_.method == FlattenMethod::kArap ? kRoughly : kExactly,
                                     cancel_)
                 : HeldFirstStep(**system, held_, n());
    if (!first) return Fail(std::move(first.error()));
    SetFirstStep(*std::move(first));
    return {};
  }

  // The first step from the factor of the anchors; false when that is not exact enough.
  Result<bool> PinnedStep() {
    const auto ground = Anchors();
    auto system = SystemHolding({{{ground[0], 0, 0}, {ground[1], 0, 0}}});
    if (!system) return false;
    order_ = (*system)->order();
    auto first = PinnedFirstStep(**system, ground, cells_, held_, n(), cancel_);
    if (!first) return Fail(std::move(first.error()));
    if (!*first) return false;
    SetFirstStep(**std::move(first));
    return true;
  }

  Result<std::shared_ptr<const GroundedSystem<Complex>>> SystemHolding(const Held& held) {
    return factors_.Get<Complex>(FirstKey("held", held), [&] {
      return Timed(HeldSystem(cells_, held, n(), [&](const auto& m) { return OrderOf(m); }));
    });
  }

  Result<std::shared_ptr<const GroundedSystem<Complex>>> FreeSystem() {
    return factors_.Get<Complex>(FirstKey("free", {}), [&] {
      return Timed(SpectralSystem(cells_, n(), [&](const auto& m) { return OrderOf(m); }));
    });
  }

  void SetFirstStep(std::vector<Complex> shape) {
    layout_.first_step = std::move(shape);
    layout_.uv = layout_.first_step;
  }

  // The second step and what refines it. Anchors have done their work: the rigid step needs one
  // vertex held, or the pins.
  Status RigidSteps() {
    const Held none;
    const Held& held = pins_ ? held_ : none;
    const bool second = options_.method == FlattenMethod::kArap;
    // The second step of FACE cells with cotangents is the first refinement.
    const bool merged = second && IsFaceCotangent(energy_);
    if (second && !merged) {
      if (auto taken = Take(held, {1, false, 0}, false); !taken) {
        return Fail(std::move(taken.error()));
      }
    }
    const int steps = options_.refine + (merged ? 1 : 0);
    if (steps == 0) return {};
    if (!merged) {
      auto face = chart_.Cells({Basis::kFace, Weights::kCotangent, energy_.rigidity});
      if (!face) return Fail(std::move(face.error()));
      cells_ = std::move(face->cells);
    }
    const double stop = options_.refine > 0 ? options_.refine_stop : 0;
    auto taken = Take(held, {steps, options_.refine > 0, stop}, true);
    if (!taken) return Fail(std::move(taken.error()));
    layout_.refinements = std::max(0, *taken - (merged ? 1 : 0));
    return {};
  }

  Result<int> Take(const Held& held, const LocalGlobalOptions& steps, bool face) {
    // With the null space one vertex is grounded, as without pins.
    const Held none;
    const Held& factored = null_space_ ? none : held;
    auto system = factors_.Get<double>(RigidKey(factored, face), [&] {
      return Timed(RigidSystem(cells_, factored, centre_[0], n(), order_));
    });
    if (!system) return Fail(std::move(system.error()));
    if (!null_space_) {
      const auto solver = FactoredRigidSolver(*std::move(system), held);
      return LocalGlobal(cells_, held, *solver, steps, cancel_, layout_.uv);
    }
    const auto solver = PinnedRigidSolver(*std::move(system), centre_[0], held, cancel_);
    if (!solver) return Fail(solver.error());
    return LocalGlobal(cells_, held, **solver, steps, cancel_, layout_.uv);
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
    auto layout = FlattenInjective(chart_.mesh, chart_.loops, layout_.uv, options, cancel_);
    if (!layout) return Fail(std::move(layout.error()));
    layout_.uv = std::move(layout->uv);
    return {};
  }

  bool IsInjective() const {
    if (!NotUpright(chart_.mesh.triangles, layout_.uv, chart_.left_out).empty()) return false;
    std::vector<bool> boundary(n());
    for (const auto& loop : chart_.loops) {
      for (const std::uint32_t v : loop) boundary[v] = true;
    }
    return WoundTwice(chart_.mesh.triangles, layout_.uv, boundary, chart_.left_out).empty();
  }

  // Into the units of the input, and to where a grain line and a single pin want it.
  void Place(const ChartWishes& wishes) {
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

  const SurfaceChart& chart_;
  const FlattenOptions& options_;
  const EnergyOptions& energy_;
  const PinSolver solver_;
  const std::string& name_;
  FactorCache& factors_;
  const CancelToken& cancel_;
  const std::array<std::uint32_t, 2> centre_;
  Held held_;
  bool pins_ = false;
  bool null_space_ = false;  // pins are solved for on factors that have none
  Complex origin_ = 0;
  Cells cells_;
  Order order_;
  ChartLayout layout_;
};

}  // namespace

Result<ChartLayout> FlattenChart(const SurfaceChart& chart, const FlattenOptions& options,
                                 const EnergyOptions& energy, PinSolver solver,
                                 const ChartWishes& wishes, const std::string& name,
                                 FactorCache& factors, const CancelToken& cancel) {
  return ChartFlattener(chart, options, energy, solver, name, factors, cancel).Flatten(wishes);
}

}  // namespace arap
