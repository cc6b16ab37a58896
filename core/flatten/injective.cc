#include "core/flatten/injective.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/flatten/tutte.h"
#include "core/flatten/upright.h"

namespace arap {
namespace {

// An energy this near to isometry is rounding.
constexpr double kExact = 1e-20;
constexpr double kArmijo = 1e-4;
constexpr double kBeforeLimit = 0.9;  // of the step that would collapse a triangle
constexpr double kLeastStep = 1e-12;

Status CheckPins(const std::vector<LayoutPin>& pins, std::size_t vertices) {
  std::vector<bool> seen(vertices, false);
  for (std::size_t k = 0; k < pins.size(); ++k) {
    const LayoutPin& pin = pins[k];
    std::string what;
    if (pin.vertex >= vertices) {
      what = fmt::format("pin {} names vertex {}; there are {}", k, pin.vertex, vertices);
    } else if (seen[pin.vertex]) {
      what = fmt::format("pin {} holds vertex {} a second time", k, pin.vertex);
    } else if (!std::isfinite(pin.uv.real()) || !std::isfinite(pin.uv.imag())) {
      what = fmt::format("pin {} of vertex {} has a place that is not finite", k, pin.vertex);
    } else if (!(pin.weight > 0)) {
      what = fmt::format("pin {} of vertex {} has the weight {}; it must be positive", k,
                         pin.vertex, pin.weight);
    } else {
      seen[pin.vertex] = true;
      continue;
    }
    return Fail(Fault{FaultKind::kInvalidOption, what, {pin.vertex}, {}, "pins"});
  }
  return {};
}

class Search {
 public:
  Search(const SurfaceMesh& mesh, std::span<const std::vector<std::uint32_t>> loops,
         const InjectiveOptions& options, const CancelToken& cancel, Newton newton)
      : mesh_(mesh),
        loops_(loops),
        options_(options),
        cancel_(cancel),
        newton_(std::move(newton)),
        boundary_(mesh.vertices.size(), false) {
    for (const auto& loop : loops) {
      for (const std::uint32_t v : loop) boundary_[v] = true;
    }
  }

  Result<InjectiveLayout> Run(std::span<const Complex> candidate) {
    InjectiveLayout layout;
    if (auto ok = Start(candidate, layout); !ok) return Fail(std::move(ok.error()));
    if (auto ok = Descend(layout); !ok) return Fail(std::move(ok.error()));
    if (!Injective(layout.uv)) return NotInjective(layout.uv);
    layout.energy = 4 + newton_.Energy(layout.uv, 0);
    return layout;
  }

 private:
  bool Injective(std::span<const Complex> uv) const {
    return NotUpright(mesh_.triangles, uv, options_.left_out).empty() &&
           WoundTwice(mesh_.triangles, uv, boundary_, options_.left_out).empty();
  }

  tl::unexpected<Fault> NotInjective(std::span<const Complex> nearest) const {
    const auto flipped = NotUpright(mesh_.triangles, nearest, options_.left_out);
    Fault fault{FaultKind::kNotInjective, "", {}, {}, "injective"};
    if (flipped.empty()) {
      fault.message = "no injective layout was reached: a vertex stays wound more than once";
      for (const auto v : WoundTwice(mesh_.triangles, nearest, boundary_, options_.left_out)) {
        fault.Element(v);
      }
    } else {
      fault.message =
          fmt::format("no injective layout was reached: {} triangles stay flipped{}",
                      flipped.size(), options_.pins.empty() ? "" : "; the pins may ask for it");
      for (const std::uint32_t t : flipped) fault.Element(t);
      fault.Detail("flipped", fmt::to_string(flipped.size()));
    }
    return Fail(std::move(fault));
  }

  void MeetHardPins(std::vector<Complex>& uv) const {
    for (const LayoutPin& pin : options_.pins) {
      if (std::isinf(pin.weight)) uv[pin.vertex] = pin.uv;
    }
  }

  // Turns and moves a layout of our own as near to the pins as it comes.
  void Approach(std::vector<Complex>& uv) const {
    if (options_.pins.empty()) return;
    Complex from = 0, to = 0, turn = 0;
    const double count = static_cast<double>(options_.pins.size());
    for (const LayoutPin& pin : options_.pins) from += uv[pin.vertex] / count, to += pin.uv / count;
    for (const LayoutPin& pin : options_.pins) {
      turn += std::conj(uv[pin.vertex] - from) * (pin.uv - to);
    }
    turn = std::abs(turn) > 0 ? turn / std::abs(turn) : 1;
    for (Complex& z : uv) z = to + turn * (z - from);
    MeetHardPins(uv);
  }

  // The first injective layout among: the candidate, Tutte's embeddings, and these untangled.
  Status Start(std::span<const Complex> candidate, InjectiveLayout& layout) {
    const bool given = candidate.size() == mesh_.vertices.size() &&
                       std::all_of(candidate.begin(), candidate.end(), [](Complex z) {
                         return std::isfinite(z.real()) && std::isfinite(z.imag());
                       });
    std::vector<std::vector<Complex>> tangled;
    if (given) {
      layout.uv.assign(candidate.begin(), candidate.end());
      MeetHardPins(layout.uv);
      if (Injective(layout.uv)) return {};
      tangled.push_back(layout.uv);
    }
    layout.start = InjectiveStart::kTutte;
    for (const TutteWeights weights : {TutteWeights::kCotangent, TutteWeights::kUniform}) {
      if (auto ok = cancel_.Check(); !ok) return ok;
      auto tutte = TutteEmbedding(mesh_, loops_, weights, options_.left_out);
      if (!tutte) return Fail(std::move(tutte.error()));
      layout.uv = std::move(*tutte);
      const bool fine = Injective(layout.uv);
      const double scale =
          fine ? newton_.BestScale(layout.uv) : 1 / std::sqrt(newton_.MeanDeterminant(layout.uv));
      for (Complex& z : layout.uv) z *= scale;
      Approach(layout.uv);
      if (fine && Injective(layout.uv)) return {};
      tangled.push_back(layout.uv);
    }
    layout.start = InjectiveStart::kUntangled;
    for (std::vector<Complex>& uv : tangled) {
      layout.uv = std::move(uv);
      if (auto ok = Untangle(layout); !ok) return ok;
      if (Injective(layout.uv)) return {};
    }
    return NotInjective(layout.uv);
  }

  // uv + t·move into trial_; its energy.
  double Try(std::span<const Complex> uv, std::span<const Complex> move, double t, double epsilon) {
    trial_.resize(uv.size());
    for (std::size_t v = 0; v < uv.size(); ++v) trial_[v] = uv[v] + t * move[v];
    return newton_.Energy(trial_, epsilon);
  }

  Status Untangle(InjectiveLayout& layout) {
    double least = newton_.LeastDeterminant(layout.uv);
    double epsilon = std::max(1e-3, std::abs(least));
    for (int i = 0; i < options_.max_iterations; ++i) {
      if (auto ok = cancel_.Check(); !ok) return ok;
      const double before = newton_.Energy(layout.uv, epsilon) + 4;
      const auto step = newton_.Direction(layout.uv, epsilon);
      if (!step) return Fail(step.error());
      ++layout.iterations;
      double t = 1, after = before;
      for (; t > kLeastStep; t /= 2) {
        const double energy = Try(layout.uv, step->move, t, epsilon) + 4;
        if (energy <= before + kArmijo * t * step->slope) {
          after = energy;
          layout.uv.swap(trial_);
          break;
        }
      }
      if (Injective(layout.uv)) return {};
      least = newton_.LeastDeterminant(layout.uv);
      // Tightened as fast as the energy falls [Garanzha et al. 2021 §3].
      const double falls = std::max(1 - after / before, 0.1);
      const double chi = 0.5 * (least + std::sqrt(least * least + epsilon * epsilon));
      const double aim = (1 - falls) * chi;
      const double next = least < aim ? 2 * std::sqrt(aim * (aim - least)) : 1e-10;
      if (!(t > kLeastStep) && !(next < epsilon)) return {};
      epsilon = next;
    }
    return {};
  }

  Status Descend(InjectiveLayout& layout) {
    double energy = newton_.Energy(layout.uv, 0);
    int idle = 0;
    for (int i = 0; i < options_.max_iterations && energy > kExact; ++i) {
      if (auto ok = cancel_.Check(); !ok) return ok;
      const auto step = newton_.Direction(layout.uv, 0);
      if (!step) return Fail(step.error());
      if (-0.5 * step->slope <= 0.1 * options_.stop * energy) break;
      const double limit = kBeforeLimit * newton_.Limit(layout.uv, step->move);
      double t = std::min(1.0, limit), next = 0;
      for (; t > kLeastStep; t /= 2) {
        next = Try(layout.uv, step->move, t, 0);
        if (next <= energy + kArmijo * t * step->slope && AllUpright(trial_)) break;
      }
      if (!(t > kLeastStep)) break;
      best_.swap(trial_);
      // A collapsed part wants to grow by far more than the quadratic model dares.
      while (2 * t <= limit) {
        const double further = Try(layout.uv, step->move, 2 * t, 0);
        if (!(further < next) || !AllUpright(trial_)) break;
        next = further;
        t *= 2;
        best_.swap(trial_);
      }
      layout.uv.swap(best_);
      ++layout.iterations;
      const double falls = energy - next;
      energy = next;
      idle = falls <= options_.stop * energy ? idle + 1 : 0;
      if (idle > 0 && (t >= 1 || idle > 1)) break;
    }
    return {};
  }

  bool AllUpright(std::span<const Complex> uv) const {
    return NotUpright(mesh_.triangles, uv, options_.left_out).empty();
  }

  const SurfaceMesh& mesh_;
  std::span<const std::vector<std::uint32_t>> loops_;
  const InjectiveOptions& options_;
  const CancelToken& cancel_;
  Newton newton_;
  std::vector<bool> boundary_;
  std::vector<Complex> trial_, best_;
};

}  // namespace

Result<InjectiveLayout> FlattenInjective(const SurfaceMesh& mesh,
                                         std::span<const std::vector<std::uint32_t>> loops,
                                         std::span<const Complex> start,
                                         const InjectiveOptions& options,
                                         const CancelToken& cancel) {
  if (auto ok = CheckPins(options.pins, mesh.vertices.size()); !ok) {
    return Fail(std::move(ok.error()));
  }
  auto newton = Newton::Make(mesh, options.pins, options.left_out);
  if (!newton) return Fail(std::move(newton.error()));
  return Search(mesh, loops, options, cancel, std::move(*newton)).Run(start);
}

}  // namespace arap
