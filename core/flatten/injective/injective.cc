#include "core/flatten/injective/injective.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/base/plane.h"
#include "core/base/try.h"
#include "core/flatten/distortion.h"
#include "core/flatten/injective/gradients.h"
#include "core/flatten/injective/newton_descent.h"
#include "core/flatten/injective/patches.h"
#include "core/flatten/injective/tutte.h"

namespace arap {
namespace {

constexpr int kUntanglingPatience = 100;  // untangling steps without fewer flips
// Steps of the quick descent before Newton's have to help.
constexpr int kMaxGradients = 300;
// It is nearer to its end than its last step tells.
constexpr double kGradientsStop = 0.1;

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
         const InjectiveOptions& options, const CancelToken& cancel)
      : mesh_(mesh),
        loops_(loops),
        options_(options),
        cancel_(cancel),
        newton_(Newton::Make(mesh, options.pins, options.left_out)),
        boundary_(mesh.vertices.size(), false) {
    for (const auto& loop : loops) {
      for (const std::uint32_t v : loop) boundary_[v] = true;
    }
  }

  Result<InjectiveLayout> Run(std::span<const Complex> candidate) {
    InjectiveLayout layout;
    CHECK_OK(Start(candidate, layout));
    TRY(const bool converged, DescendQuickly(layout));
    if (!converged) {
      CHECK_OK(
          Descend(Problem(), options_.stop, options_.max_iterations, layout.uv, layout.iterations));
    }
    if (!Injective(layout.uv)) return NotInjective(layout.uv);
    layout.energy = 4 + newton_.Distortion(layout.uv, 0);
    Add(newton_.times(), layout);
    return layout;
  }

 private:
  static void Add(const FactorTimes& times, InjectiveLayout& layout) {
    layout.times.analysis += times.analysis;
    layout.times.numbers += times.numbers;
  }

  // Whether that was all there is to do.
  Result<bool> DescendQuickly(InjectiveLayout& layout) const {
    const int most = std::min(kMaxGradients, options_.max_iterations);
    const GradientsOptions options{most, kGradientsStop * options_.stop, options_.pins,
                                   options_.left_out};
    TRY(const auto quick, DescendGradients(mesh_, options, cancel_, layout.uv));
    layout.iterations += quick.iterations;
    Add(quick.times, layout);
    return quick.converged;
  }

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

  // The first injective layout that meets the hard pins among: the candidate, the candidate mended
  // around its flips, Tutte's embeddings, these pulled to the pins, and all of them untangled.
  Status Start(std::span<const Complex> candidate, InjectiveLayout& layout) {
    std::vector<std::vector<Complex>> starts;  // injective or not, pins not met
    const bool given = candidate.size() == mesh_.vertices.size() &&
                       std::all_of(candidate.begin(), candidate.end(), IsFinite);
    if (given) {
      starts.emplace_back(candidate.begin(), candidate.end());
      layout.uv = starts.back();
      if (MeetsPins(layout.uv)) return {};
      CHECK_OK(CheckHardTriangles(layout.uv));
      TRY(const bool upright, MendPatches(mesh_, options_.pins, options_.left_out, cancel_,
                                          layout.uv, layout.iterations));
      layout.start = InjectiveStart::kMended;
      if (upright && Injective(layout.uv)) return {};
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
      CHECK_OK(Untangle(Problem(), kUntanglingPatience, layout.uv, layout.iterations));
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
      Newton newton = Newton::Make(mesh_, soft, options_.left_out);
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
  return Search(mesh, loops, options, cancel).Run(start);
}

}  // namespace arap
