#include "core/flatten/injective/gradients.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>

#include "core/base/lanes.h"
#include "core/base/try.h"
#include "core/flatten/injective/dirichlet.h"
#include "core/flatten/injective/newton_descent.h"

namespace arap {
namespace {

constexpr int kLittleSteps = 2;  // steps in a row that have to bring little
// The stiffness matrix does not feel translations; this share of the diagonal makes it definite.
constexpr double kStiffnessShift = 1e-9;
// What a new matrix costs, in steps.
constexpr double kRenewal = 40;

using Points = std::vector<Complex>;

// A complex number is two doubles in a row, says the standard.
const double* NumbersIn(const Points& points) {
  return reinterpret_cast<const double*>(points.data());
}

// Scalar products of the pull and of what has gone of it in the last step, with the direction of the
// matrix and with the last one that was taken.
struct Products {
  double pull_plain, gone_plain, gone_along, pull_along;
};

Products ProductsOf(const Points& pull, const Points& last_pull, const Points& plain,
                    const Points& along) {
  // In eight parts, which do not wait for one another.
  constexpr std::size_t kParts = 8;
  using Eight = Lanes<kParts>;
  const double *p = NumbersIn(pull), *l = NumbersIn(last_pull);
  const double *d = NumbersIn(plain), *a = NumbersIn(along);
  const std::size_t count = 2 * pull.size();
  Eight pull_plain{}, gone_plain{}, gone_along{}, pull_along{};
  std::size_t i = 0;
  for (; i + kParts <= count; i += kParts) {
    const Eight now = *reinterpret_cast<const Eight*>(p + i);
    const Eight gone = *reinterpret_cast<const Eight*>(l + i) - now;
    const Eight own = *reinterpret_cast<const Eight*>(d + i);
    const Eight last = *reinterpret_cast<const Eight*>(a + i);
    pull_plain += now * own;
    gone_plain += gone * own;
    gone_along += gone * last;
    pull_along += now * last;
  }
  for (std::size_t k = 0; i < count; ++i, ++k) {
    const double gone = l[i] - p[i];
    pull_plain[k] += p[i] * d[i];
    gone_plain[k] += gone * d[i];
    gone_along[k] += gone * a[i];
    pull_along[k] += p[i] * a[i];
  }
  const auto sum = [](const Eight& parts) {
    return ((parts[0] + parts[4]) + (parts[2] + parts[6])) +
           ((parts[1] + parts[5]) + (parts[3] + parts[7]));
  };
  return {sum(pull_plain), sum(gone_plain), sum(gone_along), sum(pull_along)};
}

class Gradients {
 public:
  Gradients(const SurfaceMesh& mesh, const GradientsOptions& options, Points& uv)
      : options_(options), passes_(mesh, options.left_out), point_(uv), n_(uv.size()) {
    for (Points* p : {&next_, &pull_, &next_pull_, &plain_, &along_}) p->resize(n_);
  }

  Result<GradientsResult> Run(const CancelToken& cancel) {
    GradientsResult result;
    double energy = Pull(point_, pull_);
    double renewed = energy;  // what the energy was then, and the steps since
    int age = 0;
    // A matrix that cannot be factored is no reason to give up: there are better steps than these.
    bool factored = !(energy > kExactLayout) || Renew({}, result.times).has_value();
    for (int little = 0; factored && result.iterations < options_.max_iterations;) {
      if (energy <= kExactLayout || little == kLittleSteps) {
        result.converged = true;
        break;
      }
      CHECK_OK(cancel.Check());
      Turn();
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
      factored = Renew(point_, result.times).has_value();
      renewed = energy, age = 0;
    }
    return result;
  }

 private:
  // Factors the stiffness matrix of an isometry, or of `layout`.
  Status Renew(std::span<const Complex> layout, FactorTimes& times) {
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
  double Pull(const Points& at, Points& pull) const {
    double energy = passes_.Pull(at, pull);
    for (const LayoutPin& pin : options_.pins) {
      if (std::isinf(pin.weight)) {
        pull[pin.vertex] = 0;
        continue;
      }
      const Complex miss = at[pin.vertex] - pin.uv;
      energy += pin.weight * std::norm(miss);
      pull[pin.vertex] -= 2 * pin.weight * miss;
    }
    return energy;
  }

  // Makes the next direction, along which the energy falls.
  void Turn() {
    const std::span<const Complex> plain = factor_->SolvePoints(pull_, 1, workspace_);
    std::copy(plain.begin(), plain.end(), plain_.begin());
    // next_pull_ is the pull before the last step.
    const Products products = ProductsOf(pull_, next_pull_, plain_, along_);
    double keep = 0;
    if (!fresh_ && products.gone_along > 0) {
      const double turned = std::min(-products.gone_plain, products.pull_plain);
      keep = std::max(0.0, turned / products.gone_along);
    }
    slope_ = products.pull_plain + keep * products.pull_along;
    if (!(slope_ > 0)) keep = 0, slope_ = products.pull_plain;
    for (std::size_t v = 0; v < n_; ++v) along_[v] = plain_[v] + keep * along_[v];
  }

  // A step that lowers the energy through upright layouts; false when there is none.
  bool Advance(double& energy) {
    const auto [limit, bend] = passes_.Look(point_, along_);
    double curvature = bend;
    for (const LayoutPin& pin : options_.pins) {
      if (std::isinf(pin.weight)) continue;
      curvature += 2 * pin.weight * std::norm(along_[pin.vertex]);
    }
    double step = curvature > 0 ? slope_ / curvature : 1;
    step = std::min({step, kBeforeCollapse * limit, kLargestStep});
    for (; step > kLeastStep; step /= 2) {
      for (std::size_t v = 0; v < n_; ++v) next_[v] = point_[v] + step * along_[v];
      const double after = Pull(next_, next_pull_);
      if (!(after < energy && after <= energy - kArmijo * step * slope_)) continue;
      energy = after;
      point_.swap(next_);
      pull_.swap(next_pull_);
      fresh_ = false;
      return true;
    }
    return false;
  }

  const GradientsOptions& options_;
  DirichletPasses passes_;
  Points& point_;
  const std::size_t n_;
  Eigen::SparseMatrix<double> lower_;
  std::unique_ptr<Factor<double>> factor_;
  Workspace workspace_;
  Points next_, pull_, next_pull_;
  Points plain_, along_;  // the direction of the matrix alone, and the one that is taken
  double slope_ = 0;      // by which the energy falls along it
  bool fresh_ = true;     // there is no last direction
};

}  // namespace

Result<GradientsResult> DescendGradients(const SurfaceMesh& mesh, const GradientsOptions& options,
                                         const CancelToken& cancel, std::vector<Complex>& uv) {
  return Gradients(mesh, options, uv).Run(cancel);
}

}  // namespace arap
