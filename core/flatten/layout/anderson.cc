#include "core/flatten/layout/anderson.h"

#include <algorithm>

#include <Eigen/Dense>

namespace arap {
namespace {

Eigen::Map<const Eigen::VectorXd> View(const std::vector<double>& values) {
  return {values.data(), static_cast<Eigen::Index>(values.size())};
}

// Keeps the small system solvable when steps are nearly parallel.
constexpr double kRidge = 1e-12;

}  // namespace

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

}  // namespace arap
