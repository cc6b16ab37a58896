// Anderson acceleration: a better next point of a fixed-point iteration from its last few.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace arap {

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

}  // namespace arap
