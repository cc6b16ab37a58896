#include "core/energy/assemble.h"

#include <algorithm>

namespace arap {
namespace {

// One residual (v_b − v_a) − t(v) e as coefficients of the few vertices that it touches.
class Residual {
 public:
  void Start() { terms_.clear(); }
  void Add(std::uint32_t vertex, Complex h) {
    for (auto& [v, sum] : terms_) {
      if (v == vertex) {
        sum += h;
        return;
      }
    }
    terms_.emplace_back(vertex, h);
  }
  std::span<const std::pair<std::uint32_t, Complex>> terms() const { return terms_; }

 private:
  std::vector<std::pair<std::uint32_t, Complex>> terms_;
};

// Calls visit(weight, terms) for every energy edge of every cell.
template <class Visit>
void ForEachResidual(const Cells& cells, Visit visit) {
  Residual residual;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    for (std::uint32_t k = cells.energy_begin[c]; k < cells.energy_begin[c + 1]; ++k) {
      const EnergyEdge& e = cells.energy[k];
      residual.Start();
      residual.Add(e.b, 1);
      residual.Add(e.a, -1);
      for (std::uint32_t m = cells.fit_begin[c]; m < cells.fit_begin[c + 1]; ++m) {
        const Complex h = cells.fit[m].g * e.rest;
        residual.Add(cells.fit[m].b, -h);
        residual.Add(cells.fit[m].a, h);
      }
      visit(e.weight, residual.terms());
    }
  }
}

template <class Scalar>
Eigen::SparseMatrix<Scalar> FromTriplets(std::vector<Eigen::Triplet<Scalar, int>>& triplets,
                                         const std::vector<bool>& fixed) {
  const auto n = static_cast<Eigen::Index>(fixed.size());
  for (std::size_t v = 0; v < fixed.size(); ++v) {
    if (fixed[v]) triplets.emplace_back(static_cast<int>(v), static_cast<int>(v), Scalar(1));
  }
  Eigen::SparseMatrix<Scalar> matrix(n, n);
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  return matrix;
}

}  // namespace

Eigen::SparseMatrix<Complex> AssembleSimilarity(const Cells& cells,
                                                const std::vector<bool>& fixed) {
  std::vector<Eigen::Triplet<Complex, int>> triplets;
  triplets.reserve(cells.energy.size() * 10 + fixed.size());
  ForEachResidual(cells, [&](double weight, auto terms) {
    for (const auto& [p, hp] : terms) {
      if (fixed[p]) continue;
      for (const auto& [q, hq] : terms) {
        if (q > p || fixed[q]) continue;
        // |h|² on the diagonal: conj(h)·h need not be exactly real.
        const Complex value =
            p == q ? Complex(weight * std::norm(hp)) : weight * std::conj(hp) * hq;
        triplets.emplace_back(static_cast<int>(p), static_cast<int>(q), value);
      }
    }
  });
  return FromTriplets(triplets, fixed);
}

Eigen::SparseMatrix<double> AssembleRigid(const Cells& cells, const std::vector<bool>& fixed) {
  std::vector<Eigen::Triplet<double, int>> triplets;
  triplets.reserve(cells.energy.size() * 3 + fixed.size());
  for (const EnergyEdge& e : cells.energy) {
    if (!fixed[e.a]) triplets.emplace_back(static_cast<int>(e.a), static_cast<int>(e.a), e.weight);
    if (!fixed[e.b]) triplets.emplace_back(static_cast<int>(e.b), static_cast<int>(e.b), e.weight);
    if (fixed[e.a] || fixed[e.b]) continue;
    const auto [low, high] = std::minmax(e.a, e.b);
    triplets.emplace_back(static_cast<int>(high), static_cast<int>(low), -e.weight);
  }
  return FromTriplets(triplets, fixed);
}

std::vector<Complex> SimilarityColumn(const Cells& cells, std::size_t vertices,
                                      std::uint32_t vertex) {
  std::vector<Complex> column(vertices);
  ForEachResidual(cells, [&](double weight, auto terms) {
    for (const auto& [q, hq] : terms) {
      if (q != vertex) continue;
      for (const auto& [p, hp] : terms) column[p] += weight * std::conj(hp) * hq;
    }
  });
  return column;
}

}  // namespace arap
