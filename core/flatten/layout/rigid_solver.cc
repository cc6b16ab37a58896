#include "core/flatten/layout/rigid_solver.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/sparse/saddle.h"

namespace arap {
namespace {

// image := the hard pins, where they are.
void MeetHardPins(const Held& held, std::span<double> image) {
  const std::size_t n = image.size() / 2;
  for (const HeldVertex& h : held.vertices) {
    if (h.weight > 0) continue;
    image[h.vertex] = h.uv.real();
    image[n + h.vertex] = h.uv.imag();
  }
}

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
      if (auto ok = cancel.Check(); !ok) return ok;
      const std::size_t count = std::min(kBlock, k - begin);
      right.assign(count * n, 0);
      for (std::size_t j = 0; j < count; ++j) right[j * n + pins_.vertices[begin + j].vertex] = 1;
      const auto z = std::span(responses_).subspan(begin * n, count * n);
      if (auto ok = factor_->Solve(right, count, z, workspace); !ok) return ok;
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
    if (auto ok = factor_->Solve(force, 2, image, workspace); !ok) return ok;
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

std::unique_ptr<const RigidSolver> FactoredRigidSolver(RigidFactor factor, Held held) {
  return std::make_unique<Factored>(std::move(factor), std::move(held));
}

Result<std::unique_ptr<const RigidSolver>> PinnedRigidSolver(RigidFactor factor,
                                                             std::uint32_t ground, Held pins,
                                                             const CancelToken& cancel) {
  auto solver = std::make_unique<Pinned>(std::move(factor), ground, std::move(pins));
  if (auto ok = solver->Prepare(cancel); !ok) return Fail(std::move(ok.error()));
  return solver;
}

}  // namespace arap
