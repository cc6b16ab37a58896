#include "core/flatten/layout/chart_factors.h"

#include <utility>

#include <fmt/format.h>

#include "core/base/cpu_timer.h"
#include "core/base/try.h"
#include "core/flatten/layout/first_step.h"
#include "core/sparse/elimination_order.h"

namespace arap {
namespace {

std::string Names(const Held& held) {
  std::string names;
  for (const HeldVertex& h : held.vertices) names += fmt::format("/{}:{}", h.vertex, h.weight);
  return names;
}

}  // namespace

ChartFactors::ChartFactors(std::string name, std::size_t vertices, FlattenMethod method,
                           const EnergyOptions& energy, FactorCache& cache)
    : name_(std::move(name)),
      vertices_(vertices),
      method_(method),
      energy_(energy),
      cache_(cache) {}

Result<ChartFactors::SimilarityFactor> ChartFactors::Holding(
    const Cells& cells, const Held& held, const std::function<void()>& assembled) {
  TRY(auto system, cache_.Get<Complex>(FirstKey("held", held), [&] {
    return Timed(HeldSystem(
        cells, held, vertices_, [&](const auto& m) { return OrderOf(m); }, assembled));
  }));
  order_ = system->order();
  return system;
}

Result<ChartFactors::SimilarityFactor> ChartFactors::Free(const Cells& cells,
                                                          const std::function<void()>& assembled) {
  TRY(auto system, cache_.Get<Complex>(FirstKey("free", {}), [&] {
    return Timed(SpectralSystem(
        cells, vertices_, [&](const auto& m) { return OrderOf(m); }, assembled));
  }));
  order_ = system->order();
  return system;
}

Result<RigidFactor> ChartFactors::Rigid(const Cells& cells, const Held& held, std::uint32_t still,
                                        bool refining) {
  std::string key;
  if (energy_.rigidity.empty()) {
    const std::string step =
        refining ? "refine" : fmt::format("rigid/{}", static_cast<int>(energy_.weights));
    key = fmt::format("{}/{}/{}{}", name_, step, CellBasis(), Names(held));
  }
  return cache_.Get<double>(
      key, [&] { return Timed(RigidSystem(cells, held, still, vertices_, order_)); });
}

// Of the cells of the first step; angle-based flattening is laid out with FACE cells.
int ChartFactors::CellBasis() const {
  return static_cast<int>(method_ == FlattenMethod::kAbf ? Basis::kFace : energy_.basis);
}

// What a factor of the first step depends on; empty when that cannot be said in a few words.
std::string ChartFactors::FirstKey(const char* step, const Held& held) const {
  if (!energy_.rigidity.empty()) return {};
  return fmt::format("{}/{}/{}/{}/{}{}", name_, step, method_ == FlattenMethod::kAbf,
                     static_cast<int>(energy_.basis), static_cast<int>(energy_.weights),
                     Names(held));
}

Result<Order> ChartFactors::OrderOf(const Eigen::SparseMatrix<Complex>& lower) {
  return cache_.GetOrder(fmt::format("{}/{}", name_, CellBasis()), [&] {
    CpuTimer timer;
    auto order = EliminationOrder(lower);
    times_.analysis += timer.Lap();
    return order;
  });
}

template <class Scalar>
Result<GroundedSystem<Scalar>> ChartFactors::Timed(Result<GroundedSystem<Scalar>> made) {
  if (!made) return made;
  const FactorTimes& times = made->factor().times();
  times_.analysis += times.analysis;
  times_.numbers += times.numbers;
  return made;
}

}  // namespace arap
