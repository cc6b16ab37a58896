#include "core/flatten/layout/local_global.h"

#include <algorithm>
#include <utility>

#include <Eigen/Dense>

#include "core/base/try.h"
#include "core/energy/assemble.h"
#include "core/energy/local_step.h"
#include "core/sparse/saddle.h"

namespace arap {
namespace {

constexpr std::size_t kAndersonWindow = 5;
// Keeps the small system solvable when steps are nearly parallel.
constexpr double kRidge = 1e-12;

Eigen::Map<const Eigen::VectorXd> View(const std::vector<double>& values) {
  return {values.data(), static_cast<Eigen::Index>(values.size())};
}

// For x → G(x): the combination of the last points with the least residual G(x) − x
// [Anderson 1965; for local/global solvers Peng et al. 2018]. Deterministic. Allocates at
// construction only.
class Anderson {
 public:
  Anderson(std::size_t size, std::size_t window);

  // From a point and its image (both `size` long) to the next point, which lands in `next`.
  void Next(std::span<const double> x, std::span<const double> image, std::span<double> next);

  // Forgets the points so far.
  void Restart() { count_ = 0; }

 private:
  std::size_t size_, window_;
  std::size_t count_ = 0;  // points since the start
  std::vector<double> last_image_, last_residual_;
  std::vector<std::vector<double>> image_steps_, residual_steps_;  // ring of `window`
};

Anderson::Anderson(std::size_t size, std::size_t window)
    : size_(size),
      window_(window),
      last_image_(size),
      last_residual_(size),
      image_steps_(window, std::vector<double>(size)),
      residual_steps_(window, std::vector<double>(size)) {}

void Anderson::Next(std::span<const double> x, std::span<const double> image,
                    std::span<double> next) {
  if (count_ > 0) {
    const std::size_t slot = (count_ - 1) % window_;
    for (std::size_t i = 0; i < size_; ++i) {
      image_steps_[slot][i] = image[i] - last_image_[i];
      residual_steps_[slot][i] = (image[i] - x[i]) - last_residual_[i];
    }
  }
  for (std::size_t i = 0; i < size_; ++i) {
    last_image_[i] = image[i];
    last_residual_[i] = image[i] - x[i];
    next[i] = image[i];
  }
  const auto m = static_cast<Eigen::Index>(std::min(count_, window_));
  ++count_;
  if (m == 0) return;
  Eigen::MatrixXd gram(m, m);
  Eigen::VectorXd right(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const auto row = View(residual_steps_[static_cast<std::size_t>(i)]);
    right[i] = row.dot(View(last_residual_));
    for (Eigen::Index j = 0; j <= i; ++j) {
      gram(i, j) = gram(j, i) = row.dot(View(residual_steps_[static_cast<std::size_t>(j)]));
    }
  }
  gram.diagonal().array() += kRidge * gram.trace();
  const Eigen::VectorXd theta = gram.ldlt().solve(right);
  if (!theta.allFinite()) return;
  for (Eigen::Index k = 0; k < m; ++k) {
    const std::vector<double>& step = image_steps_[static_cast<std::size_t>(k)];
    for (std::size_t i = 0; i < size_; ++i) next[i] -= theta[k] * step[i];
  }
}

// One chart's rigid step, ready to be repeated. Points are x…, y….
class Step {
 public:
  Step(const Cells& cells, const Held& held, const RigidSolver& solver, std::size_t vertices)
      : cells_(cells), held_(held), solver_(solver), n_(vertices), right_(2 * n_) {}

  // image := the best positions for the rotations of `point`.
  Status Take(const std::vector<double>& point, std::vector<double>& image) {
    std::fill(right_.begin(), right_.end(), 0.0);
    AddRotatedEdges(cells_, {point.data(), point.data() + n_}, mean_,
                    {right_.data(), right_.data() + n_});
    image = point;
    return solver_.Solve(right_, image, workspace_);
  }

  // With the rotations that fit `point` best, soft pins included.
  double Energy(const std::vector<double>& point) const {
    double energy = RigidEnergy(cells_, {point.data(), point.data() + n_});
    for (const HeldVertex& h : held_.vertices) {
      energy += h.weight * std::norm(Complex(point[h.vertex], point[n_ + h.vertex]) - h.uv);
    }
    return energy;
  }

 private:
  const Cells& cells_;
  const Held& held_;
  const RigidSolver& solver_;
  std::size_t n_;
  std::vector<double> right_;
  std::vector<Complex> mean_{0};
  Workspace workspace_;
};

bool Settled(double before, double after, double stop) {
  return stop > 0 && before - after <= stop * before;
}

Result<int> Plain(Step& step, const LocalGlobalOptions& options, const CancelToken& cancel,
                  std::vector<double>& point) {
  std::vector<double> image;
  for (int taken = 0; taken < options.iterations; ++taken) {
    CHECK_OK(cancel.Check());
    CHECK_OK(step.Take(point, image));
    point.swap(image);
  }
  return options.iterations;
}

// A guess that does not lower the energy is dropped for the plain image of the point before, which
// always does.
Result<int> Accelerated(Step& step, const LocalGlobalOptions& options, const CancelToken& cancel,
                        std::vector<double>& point) {
  Anderson anderson(point.size(), kAndersonWindow);
  std::vector<double> image, safe;
  double energy = step.Energy(point);
  int taken = 0;
  while (taken < options.iterations) {
    CHECK_OK(cancel.Check());
    CHECK_OK(step.Take(point, image));
    ++taken;
    safe = image;
    if (taken == options.iterations) {
      point.swap(safe);
      break;
    }
    anderson.Next(point, image, point);
    const double before = energy;
    energy = step.Energy(point);
    if (!(energy < before)) {
      point = safe;
      energy = step.Energy(point);
      anderson.Restart();
      if (Settled(before, energy, options.stop)) break;
    } else if (Settled(before, energy, options.stop)) {
      break;
    }
  }
  return taken;
}

// Puts the hard pins where they have to be.
void MeetHardPins(const Held& held, std::span<double> image) {
  const std::size_t n = image.size() / 2;
  for (const HeldVertex& h : held.vertices) {
    if (h.weight > 0) continue;
    image[h.vertex] = h.uv.real();
    image[n + h.vertex] = h.uv.imag();
  }
}

// With the held vertices in the factor.
class Factored : public RigidSolver {
 public:
  Factored(RigidFactor factor, Held held) : factor_(std::move(factor)), held_(std::move(held)) {}

  Status Solve(std::span<double> force, std::span<double> image,
               Workspace& workspace) const override {
    const std::size_t n = image.size() / 2;
    for (const HeldVertex& h : held_.vertices) {
      force[h.vertex] += h.weight * h.uv.real();
      force[n + h.vertex] += h.weight * h.uv.imag();
    }
    MeetHardPins(held_, image);
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

  Status Solve(std::span<double> force, std::span<double> image,
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
        scratch.right[static_cast<Eigen::Index>(i)] =
            (side == 0 ? pin.uv.real() : pin.uv.imag()) - x[pin.vertex];
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
    MeetHardPins(pins_, image);
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
  return GroundedSystem<double>::Make(matrix, std::move(fixed), FactorLayout::kPacked,
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

Result<int> LocalGlobal(const Cells& cells, const Held& held, const RigidSolver& solver,
                        const LocalGlobalOptions& options, const CancelToken& cancel,
                        std::vector<Complex>& shape) {
  const std::size_t n = shape.size();
  Step step(cells, held, solver, n);
  std::vector<double> point(2 * n);
  for (std::size_t v = 0; v < n; ++v) {
    point[v] = shape[v].real();
    point[n + v] = shape[v].imag();
  }
  TRY(const int taken, options.accelerate ? Accelerated(step, options, cancel, point)
                                          : Plain(step, options, cancel, point));
  for (std::size_t v = 0; v < n; ++v) shape[v] = {point[v], point[n + v]};
  return taken;
}

}  // namespace arap
