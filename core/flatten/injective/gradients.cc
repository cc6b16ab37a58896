#include "core/flatten/injective/gradients.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>

#include "core/base/try.h"
#include "core/flatten/distortion.h"
#include "core/flatten/injective/dirichlet.h"
#include "core/flatten/injective/newton_descent.h"

namespace arap {
namespace {

constexpr int kLittleSteps = 2;  // steps in a row that have to bring little
// The stiffness matrix does not feel translations; this share of the diagonal makes it definite.
constexpr double kStiffnessShift = 1e-9;
// What a new matrix costs, in steps.
constexpr double kRenewal = 80;

// Points are x…, y….
using FlatPoint = std::vector<double>;
ConstShapeView Seen(const FlatPoint& point) {
  return {point.data(), point.data() + point.size() / 2};
}
ShapeView Edited(FlatPoint& point) { return {point.data(), point.data() + point.size() / 2}; }

double Product(const FlatPoint& a, const FlatPoint& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

class Gradients {
 public:
  Gradients(const SurfaceMesh& mesh, const GradientsOptions& options, std::vector<Complex>& uv)
      : mesh_(mesh), options_(options), passes_(mesh, options.left_out), uv_(uv), n_(uv.size()) {
    for (FlatPoint* p : {&point_, &next_, &pull_, &next_pull_, &plain_, &along_}) p->resize(2 * n_);
    for (std::size_t v = 0; v < n_; ++v) {
      point_[v] = uv[v].real();
      point_[n_ + v] = uv[v].imag();
    }
  }

  Result<GradientsResult> Run(const CancelToken& cancel) {
    GradientsResult result;
    double energy = Pull(point_, pull_);
    double renewed = energy;  // what the energy was then, and the steps since
    int age = 0;
    // A matrix that cannot be factored is no reason to give up: there are better steps than these.
    bool factored = !(energy > kExactLayout) || Renew(nullptr, result.times).has_value();
    for (int little = 0; factored && result.iterations < options_.max_iterations;) {
      if (energy <= kExactLayout || little == kLittleSteps) {
        result.converged = true;
        break;
      }
      CHECK_OK(cancel.Check());
      CHECK_OK(Turn());
      const double before = energy;
      if (!Advance(energy)) {
        if (fresh_) break;  // rounding, or the descent is not for this layout
        fresh_ = true;
        continue;
      }
      ++result.iterations, ++age;
      const double fall = before - energy;
      little = fall <= options_.stop * before ? little + 1 : 0;
      // A step that brings less than the mean of those with this matrix, itself included.
      if (age < 2 || fall * (kRenewal + age) >= renewed - energy) continue;
      const ConstShapeView layout = Seen(point_);
      factored = Renew(&layout, result.times).has_value();
      renewed = energy, age = 0;
    }
    for (std::size_t v = 0; v < n_; ++v) uv_[v] = {point_[v], point_[n_ + v]};
    return result;
  }

 private:
  // Factors the stiffness matrix of an isometry, or of `layout`.
  Status Renew(const ConstShapeView* layout, FactorTimes& times) {
    if (!factor_) {
      lower_ = passes_.Pattern(n_);
      TRY(factor_, Factor<double>::Analyse(lower_, FactorLayout::kPacked));
      times.analysis = factor_->times().analysis;
    }
    passes_.Fill(layout, lower_);
    std::vector<bool> held(n_, false);
    std::vector<double> soft(n_, 0);
    for (const LayoutPin& pin : options_.pins) {
      if (std::isinf(pin.weight)) {
        held[pin.vertex] = true;
      } else {
        soft[pin.vertex] = 2 * pin.weight;
      }
    }
    for (int j = 0; j < lower_.outerSize(); ++j) {
      for (Eigen::SparseMatrix<double>::InnerIterator it(lower_, j); it; ++it) {
        const auto a = static_cast<std::size_t>(it.row()), b = static_cast<std::size_t>(j);
        if (a == b) {
          // Nothing pulls at a vertex whose triangles are all left out: it stays.
          const bool idle = !(it.value() > 0) || held[a];
          it.valueRef() = idle ? 1 : it.value() * (1 + kStiffnessShift) + soft[a];
        } else if (held[a] || held[b]) {
          it.valueRef() = 0;
        }
      }
    }
    CHECK_OK(factor_->Again(lower_));
    times.numbers += factor_->times().numbers;
    fresh_ = true;
    return {};
  }

  // −∇E in `pull`, 0 at hard pins.
  double Pull(const FlatPoint& at, FlatPoint& pull) const {
    double energy = passes_.Pull(Seen(at), Edited(pull), n_);
    for (const LayoutPin& pin : options_.pins) {
      double &x = pull[pin.vertex], &y = pull[n_ + pin.vertex];
      if (std::isinf(pin.weight)) {
        x = y = 0;
        continue;
      }
      const Complex miss = Complex(at[pin.vertex], at[n_ + pin.vertex]) - pin.uv;
      energy += pin.weight * std::norm(miss);
      x -= 2 * pin.weight * miss.real();
      y -= 2 * pin.weight * miss.imag();
    }
    return energy;
  }

  // Makes the next direction, along which the energy falls.
  Status Turn() {
    TRY(const auto solution, factor_->Solve(pull_, 2, workspace_));
    std::copy(solution.begin(), solution.end(), plain_.begin());
    const double plain_slope = Product(pull_, plain_);
    double keep = 0;
    if (!fresh_) {
      // next_pull_ is the pull before the last step.
      double turned = 0, bent = 0;
      for (std::size_t i = 0; i < pull_.size(); ++i) {
        const double change = next_pull_[i] - pull_[i];
        turned -= change * plain_[i];
        bent += change * along_[i];
      }
      if (bent > 0) keep = std::max(0.0, std::min(turned, plain_slope) / bent);
    }
    for (std::size_t i = 0; i < along_.size(); ++i) along_[i] = plain_[i] + keep * along_[i];
    slope_ = Product(pull_, along_);
    if (!(slope_ > 0)) {
      along_ = plain_;
      slope_ = plain_slope;
    }
    return {};
  }

  // A step that lowers the energy; false when there is none.
  bool Advance(double& energy) {
    const auto [limit, bend] = passes_.Look(Seen(point_), Seen(along_));
    double curvature = bend;
    for (const LayoutPin& pin : options_.pins) {
      if (std::isinf(pin.weight)) continue;
      const double x = along_[pin.vertex], y = along_[n_ + pin.vertex];
      curvature += 2 * pin.weight * (x * x + y * y);
    }
    double step = curvature > 0 ? slope_ / curvature : 1;
    step = std::min({step, kBeforeCollapse * limit, kLargestStep});
    for (; step > kLeastStep; step /= 2) {
      for (std::size_t i = 0; i < next_.size(); ++i) next_[i] = point_[i] + step * along_[i];
      const double after = Pull(next_, next_pull_);
      if (!(after < energy && after <= energy - kArmijo * step * slope_) || !IsUpright()) continue;
      energy = after;
      point_.swap(next_);
      pull_.swap(next_pull_);
      fresh_ = false;
      return true;
    }
    return false;
  }

  // Whether no triangle of the next point is flipped, by more than rounding.
  bool IsUpright() {
    for (std::size_t v = 0; v < n_; ++v) uv_[v] = {next_[v], next_[n_ + v]};
    return NotUpright(mesh_.triangles, uv_, options_.left_out).empty();
  }

  const SurfaceMesh& mesh_;
  const GradientsOptions& options_;
  DirichletPasses passes_;
  std::vector<Complex>& uv_;
  const std::size_t n_;
  Eigen::SparseMatrix<double> lower_;
  std::unique_ptr<Factor<double>> factor_;
  Workspace workspace_;
  FlatPoint point_, next_, pull_, next_pull_;
  FlatPoint plain_, along_;  // the direction of the matrix alone, and the one that is taken
  double slope_ = 0;         // by which the energy falls along it
  bool fresh_ = true;        // there is no last direction
};

}  // namespace

Result<GradientsResult> DescendGradients(const SurfaceMesh& mesh, const GradientsOptions& options,
                                         const CancelToken& cancel, std::vector<Complex>& uv) {
  return Gradients(mesh, options, uv).Run(cancel);
}

}  // namespace arap
