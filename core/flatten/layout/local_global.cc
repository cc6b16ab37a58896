#include "core/flatten/layout/local_global.h"

#include <algorithm>

#include "core/energy/assemble.h"
#include "core/energy/local_step.h"
#include "core/flatten/layout/anderson.h"

namespace arap {
namespace {

constexpr std::size_t kAndersonWindow = 5;

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
    if (auto ok = cancel.Check(); !ok) return Fail(std::move(ok.error()));
    if (auto ok = step.Take(point, image); !ok) return Fail(std::move(ok.error()));
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
    if (auto ok = cancel.Check(); !ok) return Fail(std::move(ok.error()));
    if (auto ok = step.Take(point, image); !ok) return Fail(std::move(ok.error()));
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
  auto taken = options.accelerate ? Accelerated(step, options, cancel, point)
                                  : Plain(step, options, cancel, point);
  if (!taken) return Fail(std::move(taken.error()));
  for (std::size_t v = 0; v < n; ++v) shape[v] = {point[v], point[n + v]};
  return taken;
}

}  // namespace arap
