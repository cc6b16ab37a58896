#include "core/flatten/layout/local_global.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Dense>

#include "core/base/try.h"
#include "core/energy/assemble.h"
#include "core/energy/local_step.h"
#include "core/energy/rigid_descent.h"
#include "core/sparse/saddle.h"

namespace arap {
namespace {

// The longest step, in those that the majorizer along the direction would take.
constexpr double kLongestStep = 100;
// Iterations in a row that have to bring little.
constexpr int kPatience = 2;

// Points are x…, y….
ConstShapeView View(const std::vector<double>& point) {
  return {point.data(), point.data() + point.size() / 2};
}
ShapeView View(std::vector<double>& point) {
  return {point.data(), point.data() + point.size() / 2};
}

Result<LocalGlobalResult> Plain(const Cells& cells, const RigidSolver& solver, int iterations,
                                const CancelToken& cancel, std::vector<double>& point) {
  const std::size_t n = point.size() / 2;
  std::vector<double> image, right(point.size());
  std::vector<Complex> shape(n), force(n);
  const std::vector<Complex> mean{0};
  Workspace workspace;
  for (int taken = 0; taken < iterations; ++taken) {
    CHECK_OK(cancel.Check());
    for (std::size_t v = 0; v < n; ++v) shape[v] = {point[v], point[n + v]};
    std::fill(force.begin(), force.end(), Complex(0));
    AddRotatedEdges(cells, shape, mean, force);
    for (std::size_t v = 0; v < n; ++v) {
      right[v] = force[v].real();
      right[n + v] = force[v].imag();
    }
    image = point;
    CHECK_OK(solver.Solve(right, {}, image, workspace));
    point.swap(image);
  }
  return LocalGlobalResult{iterations, false};
}

// Conjugate gradients on the rigid energy with the rigid matrix L for an inner product.
class Descent {
 public:
  Descent(const Cells& cells, const Held& held, const RigidSolver& solver,
          std::vector<double>& point)
      : held_(held),
        solver_(solver),
        energy_of_(cells),
        point_(point),
        pull_(point.size()),
        next_(point.size()),
        next_pull_(point.size()),
        plain_(point.size()),
        along_(point.size()),
        along_force_(point.size()),
        right_(point.size()) {}

  Result<LocalGlobalResult> Run(const LocalGlobalOptions& options, const CancelToken& cancel) {
    double energy = Pull(point_, pull_);
    LocalGlobalResult result;
    for (int little = 0; result.taken < options.iterations;) {
      CHECK_OK(cancel.Check());
      CHECK_OK(FindDirection());
      if (!(plain_slope_ > 0)) {  // no force is left
        result.converged = true;
        break;
      }
      ++result.taken;
      const double before = energy;
      if (!Advance(energy)) {
        result.converged = true;
        break;
      }
      const bool brought = before - energy > options.stop * before;
      little = brought ? 0 : little + 1;
      if (options.stop > 0 && little >= kPatience) {
        result.converged = true;
        break;
      }
    }
    return result;
  }

 private:
  // The energy of `point`, soft pins included; `pull` becomes half of its downhill gradient.
  double Pull(const std::vector<double>& point, std::vector<double>& pull) {
    const std::size_t n = point.size() / 2;
    double energy = energy_of_.Pull(View(point), View(pull), n);
    for (const HeldVertex& h : held_.vertices) {
      if (h.weight == 0) continue;
      const double x = h.uv.real() - point[h.vertex], y = h.uv.imag() - point[n + h.vertex];
      energy += h.weight * (x * x + y * y);
      pull[h.vertex] += h.weight * x;
      pull[n + h.vertex] += h.weight * y;
    }
    return energy;
  }

  // plain_ := the plain step; along_ := the direction made of it and the last one.
  Status FindDirection() {
    // The pins' share of the force is the solver's to add.
    right_ = pull_;
    const std::size_t n = point_.size() / 2;
    for (const HeldVertex& h : held_.vertices) {
      if (h.weight == 0) continue;
      right_[h.vertex] -= h.weight * (h.uv.real() - point_[h.vertex]);
      right_[n + h.vertex] -= h.weight * (h.uv.imag() - point_[n + h.vertex]);
    }
    std::fill(plain_.begin(), plain_.end(), 0.0);
    CHECK_OK(solver_.Solve(right_, point_, plain_, workspace_));
    const double last_slope = slope_;
    double turned = 0, kept = 0;
    plain_slope_ = 0;
    for (std::size_t i = 0; i < plain_.size(); ++i) {
      plain_slope_ += plain_[i] * pull_[i];
      turned += plain_[i] * (pull_[i] - next_pull_[i]);  // next_pull_ has the last pull
      kept += along_[i] * pull_[i];
    }
    // The hybrid of Hestenes–Stiefel and Dai–Yuan.
    const double change = last_slope - kept;
    double share = 0;
    if (!fresh_ && change > 0) {
      share = std::max(0.0, std::min(turned, plain_slope_) / change);
    }
    slope_ = plain_slope_ + share * kept;
    if (!(slope_ > 0) || !std::isfinite(slope_)) share = 0, slope_ = plain_slope_;
    stiffness_ = 0;
    for (std::size_t i = 0; i < plain_.size(); ++i) {
      along_[i] = plain_[i] + share * along_[i];
      along_force_[i] = pull_[i] + share * along_force_[i];
      stiffness_ += along_[i] * along_force_[i];
    }
    return {};
  }

  // A step that lowers the energy; false when there is none.
  bool Advance(double& energy) {
    double step = 1;
    if (!first_) {
      const double curvature = stiffness_ - energy_of_.Bend(View(std::as_const(along_)));
      step = std::min(curvature > 0 ? slope_ / curvature : kLongestStep,
                      kLongestStep * slope_ / stiffness_);
    }
    double after = Try(along_, step);
    fresh_ = first_;
    first_ = false;
    if (!(after < energy)) {
      after = Try(plain_, 1);
      fresh_ = true;
      if (!(after < energy)) return false;
    }
    energy = after;
    point_.swap(next_);
    pull_.swap(next_pull_);
    return true;
  }

  double Try(const std::vector<double>& move, double step) {
    for (std::size_t i = 0; i < move.size(); ++i) next_[i] = point_[i] + step * move[i];
    return Pull(next_, next_pull_);
  }

  const Held& held_;
  const RigidSolver& solver_;
  RigidDescent energy_of_;
  std::vector<double>& point_;
  std::vector<double> pull_, next_, next_pull_;
  std::vector<double> plain_;                // L⁻¹ pull
  std::vector<double> along_, along_force_;  // the direction, and L times it
  std::vector<double> right_;
  double plain_slope_ = 0, slope_ = 0, stiffness_ = 0;
  bool first_ = true;  // the second step of the paper is a plain one
  bool fresh_ = true;  // the last direction is of no use
  Workspace workspace_;
};

// Where a pin has to go, as seen from a shape; from 0 when there is none.
Complex Goal(const HeldVertex& pin, std::span<const double> from) {
  if (from.empty()) return pin.uv;
  return pin.uv - Complex(from[pin.vertex], from[from.size() / 2 + pin.vertex]);
}

// Puts the hard pins where they have to be.
void MeetHardPins(const Held& held, std::span<const double> from, std::span<double> image) {
  const std::size_t n = image.size() / 2;
  for (const HeldVertex& h : held.vertices) {
    if (h.weight > 0) continue;
    const Complex goal = Goal(h, from);
    image[h.vertex] = goal.real();
    image[n + h.vertex] = goal.imag();
  }
}

// With the held vertices in the factor.
class Factored : public RigidSolver {
 public:
  Factored(RigidFactor factor, Held held) : factor_(std::move(factor)), held_(std::move(held)) {}

  Status Solve(std::span<double> force, std::span<const double> from, std::span<double> image,
               Workspace& workspace) const override {
    const std::size_t n = image.size() / 2;
    for (const HeldVertex& h : held_.vertices) {
      const Complex goal = Goal(h, from);
      force[h.vertex] += h.weight * goal.real();
      force[n + h.vertex] += h.weight * goal.imag();
    }
    MeetHardPins(held_, from, image);
    return factor_->Solve(force, 2, image, workspace);
  }

 private:
  const RigidFactor factor_;
  const Held held_;
};

// On a factor that holds one vertex: the null-space form with the pins as rows.
class Pinned : public RigidSolver {
 public:
  Pinned(RigidFactor factor, std::uint32_t ground, Held pins)
      : factor_(std::move(factor)), ground_(ground), pins_(std::move(pins)) {}

  Status Prepare(const CancelToken& cancel) {
    const std::size_t n = factor_->factor().size(), k = pins_.vertices.size();
    responses_.resize(k * n);
    Workspace workspace;
    std::vector<double> right;
    for (std::size_t begin = 0; begin < k; begin += kBlock) {
      CHECK_OK(cancel.Check());
      const std::size_t count = std::min(kBlock, k - begin);
      right.assign(count * n, 0);
      for (std::size_t j = 0; j < count; ++j) right[j * n + pins_.vertices[begin + j].vertex] = 1;
      const auto z = std::span(responses_).subspan(begin * n, count * n);
      CHECK_OK(factor_->Solve(right, count, z, workspace));
    }
    const auto rows = static_cast<Eigen::Index>(k);
    Eigen::MatrixXd cz(rows, rows);
    for (Eigen::Index j = 0; j < rows; ++j) {
      const double* z = Response(static_cast<std::size_t>(j));
      for (Eigen::Index i = 0; i < rows; ++i) {
        cz(i, j) = z[pins_.vertices[static_cast<std::size_t>(i)].vertex];
      }
      cz(j, j) += Held::Compliance(pins_.vertices[static_cast<std::size_t>(j)]);
    }
    saddle_ = Saddle<double>(cz, Eigen::MatrixXd::Ones(rows, 1));
    return {};
  }

  Status Solve(std::span<double> force, std::span<const double> from, std::span<double> image,
               Workspace& workspace) const override {
    const std::size_t n = image.size() / 2, k = pins_.vertices.size();
    image[ground_] = image[n + ground_] = 0;
    CHECK_OK(factor_->Solve(force, 2, image, workspace));
    Saddle<double>::Scratch scratch;
    scratch.Resize(saddle_.size());
    for (std::size_t side = 0; side < 2; ++side) {
      double* x = image.data() + side * n;
      for (std::size_t i = 0; i < k; ++i) {
        const HeldVertex& pin = pins_.vertices[i];
        const Complex goal = Goal(pin, from);
        scratch.right[static_cast<Eigen::Index>(i)] =
            (side == 0 ? goal.real() : goal.imag()) - x[pin.vertex];
      }
      saddle_.Solve(scratch);
      for (std::size_t i = 0; i < k; ++i) {
        const double* z = Response(i);
        const double lambda = scratch.solution[static_cast<Eigen::Index>(i)];
        for (std::size_t v = 0; v < n; ++v) x[v] += lambda * z[v];
      }
      const double shift = scratch.solution[static_cast<Eigen::Index>(k)];
      for (std::size_t v = 0; v < n; ++v) x[v] += shift;
    }
    MeetHardPins(pins_, from, image);
    return {};
  }

 private:
  static constexpr std::size_t kBlock = 4;  // as many as the factor takes at once

  const double* Response(std::size_t pin) const {
    return responses_.data() + pin * factor_->factor().size();
  }

  const RigidFactor factor_;
  const std::uint32_t ground_;
  const Held pins_;
  std::vector<double> responses_;  // Z, #V for each pin
  Saddle<double> saddle_;
};

}  // namespace

Result<GroundedSystem<double>> RigidSystem(const Cells& cells, const Held& held,
                                           std::uint32_t still, std::size_t vertices, Order order) {
  Eigen::SparseMatrix<double> matrix = AssembleRigid(cells, std::vector<bool>(vertices, false));
  std::vector<bool> fixed = held.Fixed(vertices);
  if (held.empty()) fixed[still] = true;
  for (const HeldVertex& h : held.vertices) {
    const auto v = static_cast<Eigen::Index>(h.vertex);
    if (h.weight > 0) matrix.coeffRef(v, v) += h.weight;
  }
  return GroundedSystem<double>::Make(std::move(matrix), std::move(fixed), FactorLayout::kPacked,
                                      std::move(order));
}

std::unique_ptr<const RigidSolver> FactoredRigidSolver(RigidFactor factor, Held held) {
  return std::make_unique<Factored>(std::move(factor), std::move(held));
}

Result<std::unique_ptr<const RigidSolver>> PinnedRigidSolver(RigidFactor factor,
                                                             std::uint32_t ground, Held pins,
                                                             const CancelToken& cancel) {
  auto solver = std::make_unique<Pinned>(std::move(factor), ground, std::move(pins));
  CHECK_OK(solver->Prepare(cancel));
  return solver;
}

Result<LocalGlobalResult> LocalGlobal(const Cells& cells, const Held& held,
                                      const RigidSolver& solver, const LocalGlobalOptions& options,
                                      const CancelToken& cancel, std::vector<Complex>& shape) {
  const std::size_t n = shape.size();
  std::vector<double> point(2 * n);
  for (std::size_t v = 0; v < n; ++v) {
    point[v] = shape[v].real();
    point[n + v] = shape[v].imag();
  }
  TRY(const auto result, options.accelerate
                             ? Descent(cells, held, solver, point).Run(options, cancel)
                             : Plain(cells, solver, options.iterations, cancel, point));
  for (std::size_t v = 0; v < n; ++v) shape[v] = {point[v], point[n + v]};
  return result;
}

}  // namespace arap
