// ChartFactors: the factors that one chart is laid flat with, kept or made for it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "arap/base/result.h"
#include "arap/model/flatten.h"
#include "core/energy/cells.h"
#include "core/flatten/layout/factor_cache.h"
#include "core/flatten/layout/held.h"
#include "core/flatten/layout/local_global.h"
#include "core/sparse/factor.h"

namespace arap {

// Every factor of a chart is made with one elimination order per basis, whatever is held and
// however it is weighted: rounding follows the order, so it must not depend on what was factored
// first. Factors with rigidity are not kept. Faults of all: kNumerical. Not thread-safe; the cache
// is.
class ChartFactors {
 public:
  using SimilarityFactor = std::shared_ptr<const GroundedSystem<Complex>>;

  // `name` tells the chart's factors from those of others in `cache`. Refers to `energy` and
  // `cache`.
  ChartFactors(std::string name, std::size_t vertices, FlattenMethod method,
               const EnergyOptions& energy, FactorCache& cache);

  // The matrix of the first step with `held` (at least two) kept.
  Result<SimilarityFactor> Holding(const Cells& cells, const Held& held);

  // The same with nothing kept, for the spectral first step.
  Result<SimilarityFactor> Free(const Cells& cells);

  // The matrix of the rigid step with `held` kept, or `still` where nothing is held. After a first
  // step, whose order it takes. `refining`: `cells` are FACE with cotangents, so that the matrix is
  // the same whatever the energy of the steps before.
  Result<RigidFactor> Rigid(const Cells& cells, const Held& held, std::uint32_t still,
                            bool refining);

  // What was spent on factors that were not there, added up.
  const FactorTimes& times() const { return times_; }

 private:
  int CellBasis() const;
  std::string FirstKey(const char* step, const Held& held) const;
  Result<Order> OrderOf(const Eigen::SparseMatrix<Complex>& lower);
  template <class Scalar>
  Result<GroundedSystem<Scalar>> Timed(Result<GroundedSystem<Scalar>> made);

  const std::string name_;
  const std::size_t vertices_;
  const FlattenMethod method_;
  const EnergyOptions& energy_;
  FactorCache& cache_;
  Order order_;
  FactorTimes times_;
};

}  // namespace arap
