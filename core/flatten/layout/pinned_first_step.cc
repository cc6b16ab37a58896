#include "core/flatten/layout/pinned_first_step.h"

#include <algorithm>
#include <cmath>

#include "core/energy/assemble.h"
#include "core/sparse/saddle.h"

namespace arap {
namespace {

// Pins solved for together: few enough to keep memory small and to be cancelled between.
constexpr std::size_t kBlock = 8;
// The shape is right when a correction changes it by no more than this part.
constexpr double kSettled = 1e-10;
constexpr int kMaxCorrections = 4;

class Pinned {
 public:
  Pinned(const GroundedSystem<Complex>& system, const std::array<std::uint32_t, 2>& ground,
         const Cells& cells, const Held& pins, std::size_t vertices)
      : system_(system),
        ground_(ground),
        cells_(cells),
        pins_(pins.vertices),
        n_(vertices),
        x_(n_),
        lambda_(pins_.size()) {}

  Result<std::optional<std::vector<Complex>>> Solve(const CancelToken& cancel) {
    if (auto ok = FindDirection(); !ok) return Fail(std::move(ok.error()));
    if (auto ok = MakeSaddle(cancel); !ok) return Fail(std::move(ok.error()));
    for (int correction = 0; correction <= kMaxCorrections; ++correction) {
      if (auto ok = cancel.Check(); !ok) return Fail(std::move(ok.error()));
      auto change = Correct();
      if (!change) return Fail(std::move(change.error()));
      if (correction > 0 && *change <= kSettled * Size(x_)) {
        for (const HeldVertex& pin : pins_) {
          if (pin.weight == 0) x_[pin.vertex] = pin.uv;
        }
        return std::move(x_);
      }
    }
    return std::optional<std::vector<Complex>>();
  }

 private:
  static double Size(const std::vector<Complex>& x) {
    double size = 0;
    for (const Complex p : x) size = std::max(size, std::norm(p));
    return std::sqrt(size);
  }

  // direction_ := the shape with the ground at 0 and 1; energy_ is its own.
  Status FindDirection() {
    direction_.assign(n_, 0);
    direction_[ground_[1]] = 1;
    std::vector<Complex> right(n_);
    if (auto ok = system_.Solve(right, 1, direction_, workspace_); !ok) return ok;
    energy_ = std::max(0.0, SimilarityForceAt(cells_, direction_).energy);
    return {};
  }

  Status MakeSaddle(const CancelToken& cancel) {
    const std::size_t k = pins_.size();
    const auto rows = static_cast<Eigen::Index>(k);
    Eigen::MatrixXcd cz(rows, rows), cn(rows, 2), energy = Eigen::MatrixXcd::Zero(2, 2);
    std::vector<Complex> right, z;
    for (std::size_t begin = 0; begin < k; begin += kBlock) {
      if (auto ok = cancel.Check(); !ok) return ok;
      const std::size_t count = std::min(kBlock, k - begin);
      right.assign(n_ * count, 0);
      z.assign(n_ * count, 0);
      for (std::size_t j = 0; j < count; ++j) right[j * n_ + pins_[begin + j].vertex] = 1;
      if (auto ok = system_.Solve(right, count, z, workspace_); !ok) return ok;
      for (std::size_t j = 0; j < count; ++j) {
        for (std::size_t i = 0; i < k; ++i) {
          cz(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(begin + j)) =
              z[j * n_ + pins_[i].vertex];
        }
      }
    }
    for (std::size_t i = 0; i < k; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      cz(row, row) += Held::Compliance(pins_[i]);
      cn(row, 0) = 1;
      cn(row, 1) = direction_[pins_[i].vertex];
    }
    energy(1, 1) = energy_;
    saddle_ = Saddle<Complex>(cz, cn, energy);
    scratch_.Resize(saddle_.size());
    return {};
  }

  // Takes from x_ and lambda_ what they still lack; the first time, that is everything. Returns
  // the largest change of a vertex.
  Result<double> Correct() {
    // What is left of  H x = Cᴴ λ  and  C x + E λ = c.
    std::vector<Complex> left = SimilarityForceAt(cells_, x_).force;
    for (Complex& f : left) f = -f;
    for (std::size_t i = 0; i < pins_.size(); ++i) left[pins_[i].vertex] += lambda_[i];
    Complex sum = 0, along = 0;
    for (std::size_t v = 0; v < n_; ++v) {
      sum += left[v];
      along += std::conj(direction_[v]) * left[v];
    }
    std::vector<Complex> right = left, change(n_);
    if (auto ok = system_.Solve(right, 1, change, workspace_); !ok) return Fail(ok.error());
    const auto k = static_cast<Eigen::Index>(pins_.size());
    for (Eigen::Index i = 0; i < k; ++i) {
      const HeldVertex& pin = pins_[static_cast<std::size_t>(i)];
      scratch_.right[i] = pin.uv - x_[pin.vertex] - change[pin.vertex] -
                          Held::Compliance(pin) * lambda_[static_cast<std::size_t>(i)];
    }
    scratch_.right[k] = -sum;
    scratch_.right[k + 1] = -along;
    saddle_.Solve(scratch_);
    const auto& solution = scratch_.solution;
    right = left;
    for (Eigen::Index i = 0; i < k; ++i) {
      right[pins_[static_cast<std::size_t>(i)].vertex] += solution[i];
      lambda_[static_cast<std::size_t>(i)] += solution[i];
    }
    std::fill(change.begin(), change.end(), Complex(0));
    if (auto ok = system_.Solve(right, 1, change, workspace_); !ok) return Fail(ok.error());
    for (std::size_t v = 0; v < n_; ++v) {
      change[v] += solution[k] + solution[k + 1] * direction_[v];
      x_[v] += change[v];
    }
    return Size(change);
  }

  const GroundedSystem<Complex>& system_;
  const std::array<std::uint32_t, 2> ground_;
  const Cells& cells_;
  const std::vector<HeldVertex>& pins_;
  const std::size_t n_;
  double energy_ = 0;
  std::vector<Complex> direction_, x_, lambda_;
  Saddle<Complex> saddle_;
  Saddle<Complex>::Scratch scratch_;
  Workspace workspace_;
};

}  // namespace

Result<std::optional<std::vector<Complex>>> PinnedFirstStep(
    const GroundedSystem<Complex>& system, const std::array<std::uint32_t, 2>& ground,
    const Cells& cells, const Held& pins, std::size_t vertices, const CancelToken& cancel) {
  return Pinned(system, ground, cells, pins, vertices).Solve(cancel);
}

}  // namespace arap
