#include "core/flatten/injective/newton_descent.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/try.h"
#include "core/flatten/distortion.h"

namespace arap {
namespace {

constexpr double kFirstEpsilon = 1e-2;
constexpr int kMaxUntangling = 1000;

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

}  // namespace

Status Untangle(const DescentProblem& problem, int patience, std::vector<Complex>& uv,
                int& iterations) {
  Walker walker(problem);
  double epsilon = std::max(kFirstEpsilon, std::abs(problem.newton.LeastDeterminant(uv)));
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  for (int i = 0, idle = 0; i < kMaxUntangling && idle < patience; ++i, ++idle) {
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

Status Descend(const DescentProblem& problem, double stop, int max_iterations,
               std::vector<Complex>& uv, int& iterations) {
  Walker walker(problem);
  double energy = problem.newton.Energy(uv, 0);
  for (int i = 0, idle = 0; i < max_iterations && energy > kExactLayout; ++i) {
    CHECK_OK(problem.cancel.Check());
    TRY(const auto step, problem.newton.Direction(uv, 0));
    if (-step.slope <= 0.1 * stop * energy) break;
    const double limit =
        std::min(kLargestStep, kBeforeCollapse * problem.newton.Limit(uv, step.move));
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

}  // namespace arap
