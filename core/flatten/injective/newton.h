// Projected Newton steps on the distortion of a layout, and the energies of a triangle that they
// descend: energies that forbid, or push back, a flip.
//
// The map of a triangle is z ↦ αz + βz̄. An energy that knows neither rotation of the surface nor
// of the plane depends on a = |α| and b = |β| alone; its singular values are s1 = a + b and
// s2 = a − b, its determinant a² − b². The Hessian over (α, β) then falls apart: a 2×2 block for
// the two lengths, one eigenvalue for turning α (twist), one for turning β (shear). That is all an
// assembler needs, and clamping it keeps the Hessian positive.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/mesh.h"
#include "core/sparse/factor.h"

namespace arap {

// Value and derivatives at (a, b). The slopes are twist·a along α and shear·b along β; both are
// also the eigenvalues of turning α and β.
struct Density {
  double twist = 0;
  double shear = 0;
  double aa = 0, ab = 0, bb = 0;  // second derivatives by a and b
};

// Symmetric Dirichlet less its least value 4: (s1 − 1/s1)² + (s2 − 1/s2)², free of cancellation
// near an isometry; infinite unless s2 > 0. Only twist can be negative.
double SymmetricDirichlet(double a, double b);
Density SymmetricDirichletDensity(double a, double b);

// (s1² + s2² + D² + 1) / χ(D) − 4 with D = s1·s2 and χ = (D + √(D² + ε²))/2: finite for flipped
// triangles too, and the steeper there the smaller ε > 0 is. As ε → 0 a barrier around D > 0
// remains.
double Untangling(double a, double b, double epsilon);
Density UntanglingDensity(double a, double b, double epsilon);

// Holds a vertex at a place of the plane; see InjectiveOptions.
struct LayoutPin {
  std::uint32_t vertex = 0;
  Complex uv;
  double weight = 0;  // of the squared distance; infinite: the vertex never moves
};

// The energy of layouts of one surface: the density of a triangle, weighted by its share of the
// rest area, plus weight·|z − uv|² for every soft pin. `epsilon` 0 is the symmetric Dirichlet
// energy less 4, which is infinite when a triangle is not upright; epsilon > 0 is Untangling. One
// object per job: the pattern of the Hessian is analysed once, when the first step is asked for.
// Not thread-safe.
class Newton {
 public:
  // Triangles in the mask `left_out` (#F or empty) have no energy.
  static Newton Make(const SurfaceMesh& mesh, std::span<const LayoutPin> pins,
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
  // gradient·step <= 0. Valid until the next call. Faults: kNumerical, kOutOfMemory.
  // [Teran et al. 2005; the eigenvalues in closed form, Smith et al. 2019, here in complex numbers]
  struct Step {
    std::span<const Complex> move;
    double slope = 0;
  };
  Result<Step> Direction(std::span<const Complex> uv, double epsilon);

  // Largest t for which no triangle of uv + t·move has collapsed; infinite when none ever does
  // [Smith and Schaefer 2015]. Needs upright triangles.
  double Limit(std::span<const Complex> uv, std::span<const Complex> move) const;

  // Of all factors so far.
  const FactorTimes& times() const { return times_; }

 private:
  // A triangle of the energy. Corner k's part in α is w[k], in β conj(w[k]).
  struct Element {
    std::array<std::uint32_t, 3> corner{};
    std::array<Complex, 3> w{};
    double area = 0;  // share of the whole
  };
  // Where the 6×6 lower triangle of one goes among the Hessian's values.
  using Slots = std::array<int, 21>;

  Newton() = default;
  void MakePattern(std::size_t vertices);
  void Add(const Element& element, const Slots& slots, std::span<const Complex> uv, double epsilon);

  std::vector<Element> elements_;
  std::vector<Slots> slots_;  // of the elements, once the pattern is made
  std::vector<LayoutPin> soft_;
  std::vector<bool> fixed_;  // #V
  Eigen::SparseMatrix<double> hessian_;
  std::vector<int> diagonal_;  // 2·#V slots
  std::unique_ptr<Factor<double>> factor_;
  FactorTimes times_;
  Workspace workspace_;
  std::vector<double> gradient_;
  std::vector<Complex> move_;
};

}  // namespace arap
