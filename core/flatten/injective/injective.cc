#include "core/flatten/injective/injective.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/base/plane.h"
#include "core/base/try.h"
#include "core/flatten/distortion.h"
#include "core/flatten/injective/tutte.h"

namespace arap {
namespace {

// An energy this near to an isometry is rounding.
constexpr double kExact = 1e-20;
constexpr double kArmijo = 1e-4;
constexpr double kLeastStep = 1e-12, kLargestStep = 1e6;
constexpr double kBeforeLimit = 0.9;  // of the step that would collapse a triangle

constexpr double kFirstEpsilon = 1e-2;
constexpr int kMaxUntangling = 1000;
constexpr int kPatience = 100;  // untangling steps without fewer flips

// What both descents work on: the energy and the triangles that count.
struct DescentProblem {
  Newton& newton;
  std::span<const Triangle> triangles;
  const std::vector<bool>& left_out;  // #F or empty
  const CancelToken& cancel;          // asked before every step
};

// Walks from one layout to the next; keeps its memory.
class Walker {
 public:
  explicit Walker(const DescentProblem& problem) : problem_(problem) {}

  // Moves uv along the step by t <= limit such that the energy falls; answers t, or 0 where no step
  // helps. Longer steps than Newton's are tried: collapsed parts want to grow by far more than the
  // quadratic model expects.
  double Advance(const Newton::Step& step, double epsilon, double limit, std::vector<Complex>& uv,
                 double& energy) {
    double t = std::min(1.0, limit), fallen = energy;
    for (;; t /= 2) {
      if (!(t > kLeastStep)) return 0;
      if (Try(step, epsilon, t, uv, fallen) && fallen <= energy + kArmijo * t * step.slope) break;
    }
    best_.swap(trial_);
    for (double further = fallen; 2 * t <= limit; t *= 2) {
      if (!Try(step, epsilon, 2 * t, uv, further) || !(further < fallen)) break;
      fallen = further;
      best_.swap(trial_);
    }
    uv.swap(best_);
    energy = fallen;
    return t;
  }

 private:
  bool Try(const Newton::Step& step, double epsilon, double t, const std::vector<Complex>& uv,
           double& energy) {
    trial_.resize(uv.size());
    for (std::size_t v = 0; v < uv.size(); ++v) trial_[v] = uv[v] + t * step.move[v];
    energy = problem_.newton.Energy(trial_, epsilon);
    return epsilon > 0 || NotUpright(problem_.triangles, trial_, problem_.left_out).empty();
  }

  const DescentProblem& problem_;
  std::vector<Complex> trial_, best_;
};

// Moves `uv` until every triangle is upright, or until no more flips have gone for a while: look at
// the result. Adds its steps to `iterations`. Faults: kNumerical, what the token answers.
// [Garanzha et al. 2021]
Status Untangle(const DescentProblem& problem, std::vector<Complex>& uv, int& iterations) {
  Walker walker(problem);
  double epsilon = std::max(kFirstEpsilon, std::abs(problem.newton.LeastDeterminant(uv)));
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  for (int i = 0, idle = 0; i < kMaxUntangling && idle < kPatience; ++i, ++idle) {
    const std::size_t flipped = NotUpright(problem.triangles, uv, problem.left_out).size();
    if (flipped == 0) break;
    if (flipped < fewest) fewest = flipped, idle = 0;
    CHECK_OK(problem.cancel.Check());
    TRY(const auto step, problem.newton.Direction(uv, epsilon));
    const double before = problem.newton.Energy(uv, epsilon);
    double after = before;
    walker.Advance(step, epsilon, kLargestStep, uv, after);
    ++iterations;
    // The faster the energy falls the sharper it may become [Garanzha et al. 2021 §3].
    const double fall = std::max((before - after) / (before + 4), 0.1);
    const double least = problem.newton.LeastDeterminant(uv);
    const double chi = 0.5 * (least + std::sqrt(least * least + epsilon * epsilon));
    const double aim = (1 - fall) * chi;
    epsilon = least < aim ? 2 * std::sqrt(aim * (aim - least)) : 1e-10;
  }
  return {};
}

// Descends the symmetric Dirichlet energy from an upright layout through upright layouts, until a
// step brings less than the fraction `stop` of what is above an isometry, or `max_iterations` are
// done. Steps count as above. [Smith and Schaefer 2015]
Status Descend(const DescentProblem& problem, double stop, int max_iterations,
               std::vector<Complex>& uv, int& iterations) {
  Walker walker(problem);
  double energy = problem.newton.Energy(uv, 0);
  for (int i = 0, idle = 0; i < max_iterations && energy > kExact; ++i) {
    CHECK_OK(problem.cancel.Check());
    TRY(const auto step, problem.newton.Direction(uv, 0));
    if (-step.slope <= 0.1 * stop * energy) break;
    const double limit = std::min(kLargestStep, kBeforeLimit * problem.newton.Limit(uv, step.move));
    const double before = energy;
    const double t = walker.Advance(step, 0, limit, uv, energy);
    if (t == 0) break;
    ++iterations;
    // A step cut short by its limit may bring little without being the last.
    idle = before - energy <= stop * energy ? idle + 1 : 0;
    if (idle > 0 && (t >= 1 || idle > 2)) break;
  }
  return {};
}

Status CheckPins(const std::vector<LayoutPin>& pins, std::size_t vertices) {
  std::vector<bool> seen(vertices, false);
  for (std::size_t k = 0; k < pins.size(); ++k) {
    const LayoutPin& pin = pins[k];
    std::string what;
    if (pin.vertex >= vertices) {
      what = fmt::format("Pin {} names vertex {}; there are {}.", k, pin.vertex, vertices);
    } else if (seen[pin.vertex]) {
      what = fmt::format("Pin {} holds vertex {} a second time.", k, pin.vertex);
    } else if (!IsFinite(pin.uv)) {
      what = fmt::format("Pin {} of vertex {} has a place that is not finite.", k, pin.vertex);
    } else if (!(pin.weight > 0)) {
      what = fmt::format("Pin {} of vertex {} has the weight {}; it must be positive.", k,
                         pin.vertex, pin.weight);
    } else {
      seen[pin.vertex] = true;
      continue;
    }
    return Fail(Fault(FaultKind::kInvalidOption, what).Field("pins").Element(pin.vertex));
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
    CHECK_OK(Start(candidate, layout));
    CHECK_OK(
        Descend(Problem(), options_.stop, options_.max_iterations, layout.uv, layout.iterations));
    if (!Injective(layout.uv)) return NotInjective(layout.uv);
    layout.energy = 4 + newton_.Distortion(layout.uv, 0);
    return layout;
  }

 private:
  DescentProblem Problem() { return {newton_, mesh_.triangles, options_.left_out, cancel_}; }

  bool Injective(std::span<const Complex> uv) const {
    return LocallyInjective(mesh_.triangles, uv, boundary_, options_.left_out);
  }

  tl::unexpected<Fault> NotInjective(std::span<const Complex> nearest) const {
    const auto flipped = NotUpright(mesh_.triangles, nearest, options_.left_out);
    Fault fault = Fault(FaultKind::kNotInjective, "").Field("injective");
    if (flipped.empty()) {
      fault.message = "No injective layout was reached: a vertex stays wound more than once.";
      fault.Elements(WoundTwice(mesh_.triangles, nearest, boundary_, options_.left_out));
    } else {
      fault.message =
          fmt::format("No injective layout was reached: {} triangles stay flipped{}.",
                      flipped.size(), options_.pins.empty() ? "" : "; the pins may ask for it");
      fault.Elements(flipped).Detail("flipped", flipped.size());
    }
    return Fail(std::move(fault));
  }

  void MeetHardPins(std::vector<Complex>& uv) const {
    for (const LayoutPin& pin : options_.pins) {
      if (std::isinf(pin.weight)) uv[pin.vertex] = pin.uv;
    }
  }

  // No layout mends a triangle that is held at all three corners: it has to be upright as it is.
  Status CheckHardTriangles(std::span<const Complex> uv) const {
    std::vector<bool> hard(mesh_.vertices.size(), false);
    for (const LayoutPin& pin : options_.pins) hard[pin.vertex] = std::isinf(pin.weight);
    for (const std::uint32_t t : NotUpright(mesh_.triangles, uv, options_.left_out)) {
      const auto& [a, b, c] = mesh_.triangles[t];
      if (!hard[a] || !hard[b] || !hard[c]) continue;
      return Fail(
          Fault(FaultKind::kNotInjective,
                fmt::format("The pins of vertices {}, {} and {} flip triangle {}.", a, b, c, t))
              .Field("pins")
              .Element(t));
    }
    return {};
  }

  // Turns and moves a layout of our own as near to the pins as it comes. Two hard pins or more fix
  // its size too, so that two alone are always met.
  void Approach(std::vector<Complex>& uv) const {
    const bool sized = HardPins() >= 2;
    Complex from = 0, to = 0, turn = 0;
    double count = 0, spread = 0;
    const auto counts = [&](const LayoutPin& pin) { return !sized || std::isinf(pin.weight); };
    for (const LayoutPin& pin : options_.pins) {
      if (counts(pin)) from += uv[pin.vertex], to += pin.uv, ++count;
    }
    if (count == 0) return;
    from /= count, to /= count;
    for (const LayoutPin& pin : options_.pins) {
      if (!counts(pin)) continue;
      turn += std::conj(uv[pin.vertex] - from) * (pin.uv - to);
      spread += std::norm(uv[pin.vertex] - from);
    }
    if (!(std::abs(turn) > 0)) {
      turn = 1;
    } else {
      turn /= sized ? spread : std::abs(turn);
    }
    for (Complex& z : uv) z = to + turn * (z - from);
  }

  std::ptrdiff_t HardPins() const {
    return std::count_if(options_.pins.begin(), options_.pins.end(),
                         [](const LayoutPin& pin) { return std::isinf(pin.weight); });
  }

  bool MeetsPins(std::vector<Complex>& uv) const {
    MeetHardPins(uv);
    return Injective(uv);
  }

  // The first injective layout that meets the hard pins among: the candidate, Tutte's embeddings,
  // these pulled to the pins, and these untangled.
  Status Start(std::span<const Complex> candidate, InjectiveLayout& layout) {
    std::vector<std::vector<Complex>> starts;  // injective or not, pins not met
    const bool given = candidate.size() == mesh_.vertices.size() &&
                       std::all_of(candidate.begin(), candidate.end(), IsFinite);
    if (given) {
      starts.emplace_back(candidate.begin(), candidate.end());
      layout.uv = starts.back();
      if (MeetsPins(layout.uv)) return {};
      CHECK_OK(CheckHardTriangles(layout.uv));
    }
    layout.start = InjectiveStart::kTutte;
    for (const TutteWeights weights : {TutteWeights::kCotangent, TutteWeights::kUniform}) {
      CHECK_OK(cancel_.Check());
      auto uv = Embedding(weights);
      if (!uv) return Fail(std::move(uv.error()));
      starts.push_back(*uv);
      layout.uv = std::move(*uv);
      if (MeetsPins(layout.uv)) return {};
      CHECK_OK(CheckHardTriangles(layout.uv));
    }
    layout.start = InjectiveStart::kMended;
    for (const std::vector<Complex>& uv : starts) {
      if (HardPins() == 0 || !Injective(uv)) continue;
      layout.uv = uv;
      CHECK_OK(Pull(layout));
      if (MeetsPins(layout.uv)) return {};
    }
    // The candidate was made for the pins; without pins the embeddings need less mending.
    if (given && options_.pins.empty())
      std::rotate(starts.begin(), starts.begin() + 1, starts.end());
    std::vector<Complex> nearest;
    std::size_t fewest = mesh_.triangles.size() + 1;
    for (std::vector<Complex>& uv : starts) {
      layout.uv = std::move(uv);
      MeetHardPins(layout.uv);
      CHECK_OK(Untangle(Problem(), layout.uv, layout.iterations));
      if (Injective(layout.uv)) return {};
      const std::size_t flipped = NotUpright(mesh_.triangles, layout.uv, options_.left_out).size();
      if (flipped < fewest) fewest = flipped, nearest = layout.uv;
    }
    return NotInjective(nearest);
  }

  // Tutte's embedding, scaled to the best size and moved near the pins.
  Result<std::vector<Complex>> Embedding(TutteWeights weights) const {
    TRY(auto uv, TutteEmbedding(mesh_, loops_, weights, options_.left_out));
    if (newton_.MeanDeterminant(uv) < 0) {  // loops that run against the triangles
      for (Complex& z : uv) z = std::conj(z);
    }
    const double scale =
        Injective(uv) ? newton_.BestScale(uv) : 1 / std::sqrt(newton_.MeanDeterminant(uv));
    for (Complex& z : uv) z *= scale;
    Approach(uv);
    return uv;
  }

  // Draws the vertices of the hard pins, softened, ever closer to their places.
  Status Pull(InjectiveLayout& layout) {
    for (const double weight : {1e1, 1e3, 1e5, 1e7}) {
      std::vector<LayoutPin> soft = options_.pins;
      for (LayoutPin& pin : soft) pin.weight = std::min(pin.weight, weight);
      TRY(auto newton, Newton::Make(mesh_, soft, options_.left_out));
      const DescentProblem problem{newton, mesh_.triangles, options_.left_out, cancel_};
      CHECK_OK(
          Descend(problem, options_.stop, options_.max_iterations, layout.uv, layout.iterations));
      std::vector<Complex> met = layout.uv;
      if (MeetsPins(met)) {
        layout.uv = std::move(met);
        break;
      }
    }
    return {};
  }

  const SurfaceMesh& mesh_;
  std::span<const std::vector<std::uint32_t>> loops_;
  const InjectiveOptions& options_;
  const CancelToken& cancel_;
  Newton newton_;
  std::vector<bool> boundary_;
};

}  // namespace

Result<InjectiveLayout> FlattenInjective(const SurfaceMesh& mesh,
                                         std::span<const std::vector<std::uint32_t>> loops,
                                         std::span<const Complex> start,
                                         const InjectiveOptions& options,
                                         const CancelToken& cancel) {
  CHECK_OK(CheckPins(options.pins, mesh.vertices.size()));
  TRY(auto newton, Newton::Make(mesh, options.pins, options.left_out));
  return Search(mesh, loops, options, cancel, std::move(newton)).Run(start);
}

}  // namespace arap
