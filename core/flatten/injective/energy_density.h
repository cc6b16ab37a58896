// Energies of one triangle that forbid, or push back, a flip.
//
// The map of a triangle is z ↦ αz + βz̄. An energy that knows neither rotation of the surface nor
// of the plane depends on a = |α| and b = |β| alone; its singular values are s1 = a + b and
// s2 = a − b, its determinant a² − b². The Hessian over (α, β) then falls apart: a 2×2 block for
// the two lengths, one eigenvalue for turning α (twist), one for turning β (shear). That is all an
// assembler needs, and clamping it keeps the Hessian positive.
#pragma once

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

}  // namespace arap
