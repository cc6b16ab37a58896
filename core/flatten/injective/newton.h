// Projected Newton steps on the distortion of a layout.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/mesh.h"
#include "core/flatten/injective/energy_density.h"
#include "core/sparse/factor.h"

namespace arap {

// Holds a vertex at a place of the plane; see InjectiveOptions.
struct LayoutPin {
  std::uint32_t vertex = 0;
  Complex uv;
  double weight = 0;  // of the squared distance; infinite: the vertex never moves
};

// The energy of layouts of one surface: the density of a triangle, weighted by its share of the
// rest area, plus weight·|z − uv|² for every soft pin. `epsilon` 0 is the symmetric Dirichlet
// energy less 4, which is infinite when a triangle is not upright; epsilon > 0 is Untangling. One
// object per job: the pattern of the Hessian is analysed once. Not thread-safe.
class Newton {
 public:
  // The mesh must outlive the object. Triangles in the mask `left_out` (#F or empty) have no
  // energy. Fault: kNumerical when memory runs out.
  static Result<Newton> Make(const SurfaceMesh& mesh, std::span<const LayoutPin> pins,
                             const std::vector<bool>& left_out);

  double Energy(std::span<const Complex> uv, double epsilon) const;

  // The part of the triangles alone.
  double Distortion(std::span<const Complex> uv, double epsilon) const;

  // The factor by which an upright layout should grow to have the least symmetric Dirichlet energy.
  double BestScale(std::span<const Complex> uv) const;

  // Area-weighted mean of the determinants of the triangles' maps, and the smallest of them.
  double MeanDeterminant(std::span<const Complex> uv) const;
  double LeastDeterminant(std::span<const Complex> uv) const;

  // The step (#V) that a quadratic model of the energy, made convex, asks for, and its slope
  // gradient·step <= 0. Valid until the next call. Fault: kNumerical. [Teran et al. 2005; the
  // eigenvalues in closed form, Smith et al. 2019, here in complex numbers]
  struct Step {
    std::span<const Complex> move;
    double slope = 0;
  };
  Result<Step> Direction(std::span<const Complex> uv, double epsilon);

  // Largest t for which no triangle of uv + t·move has collapsed; infinite when none ever does
  // [Smith and Schaefer 2015]. Needs upright triangles.
  double Limit(std::span<const Complex> uv, std::span<const Complex> move) const;

 private:
  // A triangle of the energy. Corner k's part in α is w[k], in β conj(w[k]).
  struct Element {
    std::array<std::uint32_t, 3> corner;
    std::array<Complex, 3> w;
    double area;                // share of the whole
    std::array<int, 21> slots;  // where its 6×6 lower triangle goes among the Hessian's values
  };

  Newton() = default;
  void MakePattern(std::size_t vertices);
  void Add(const Element& element, std::span<const Complex> uv, double epsilon);

  std::vector<Element> elements_;
  std::vector<LayoutPin> soft_;
  std::vector<bool> fixed_;  // #V
  Eigen::SparseMatrix<double> hessian_;
  std::vector<int> diagonal_;  // 2·#V slots
  std::unique_ptr<Factor<double>> factor_;
  Workspace workspace_;
  std::vector<double> gradient_;
  std::vector<Complex> move_;
};

}  // namespace arap
