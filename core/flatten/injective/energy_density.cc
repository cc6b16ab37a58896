#include "core/flatten/injective/energy_density.h"

#include <cmath>
#include <limits>

namespace arap {

double SymmetricDirichlet(double a, double b) {
  const double s1 = a + b, s2 = a - b;
  if (!(s2 > 0)) return std::numeric_limits<double>::infinity();
  const double d1 = s1 - 1 / s1, d2 = s2 - 1 / s2;
  return d1 * d1 + d2 * d2;
}

Density SymmetricDirichletDensity(double a, double b) {
  const double s1 = a + b, s2 = a - b;
  const double i1 = 1 / (s1 * s1), i2 = 1 / (s2 * s2);
  const double g11 = 2 + 6 * i1 * i1, g22 = 2 + 6 * i2 * i2;  // second derivatives by s1 and s2
  const double d = s1 * s2, d3 = 1 / (d * d * d);
  Density density;
  density.twist = 4 * (1 - (s1 * s1 - d + s2 * s2) * d3);
  density.shear = 4 * (1 + (s1 * s1 + d + s2 * s2) * d3);
  density.aa = density.bb = g11 + g22;
  density.ab = g11 - g22;
  return density;
}

namespace {

// χ without cancellation at negative d.
double Regular(double d, double epsilon) {
  const double root = std::sqrt(d * d + epsilon * epsilon);
  return d > 0 ? 0.5 * (d + root) : 0.5 * epsilon * epsilon / (root - d);
}

}  // namespace

double Untangling(double a, double b, double epsilon) {
  const double d = a * a - b * b;
  return (2 * (a * a + b * b) + d * d + 1) / Regular(d, epsilon) - 4;
}

Density UntanglingDensity(double a, double b, double epsilon) {
  // As a function h(N, D) of N = 2(a² + b²) and D = a² − b², linear in N.
  const double d = a * a - b * b, m = 2 * (a * a + b * b) + d * d + 1;
  const double root = std::sqrt(d * d + epsilon * epsilon);
  const double chi = Regular(d, epsilon);
  const double slope = chi / root;                                     // χ'
  const double bend = 0.5 * epsilon * epsilon / (root * root * root);  // χ''
  const double q = slope / chi;
  const double h_n = 1 / chi;
  const double h_nd = -q / chi;
  const double h_d = (2 * d - m * q) / chi;
  const double h_dd = (2 - 4 * d * q + m * (2 * q * q - bend / chi)) / chi;
  Density density;
  density.twist = 4 * h_n + 2 * h_d;
  density.shear = 4 * h_n - 2 * h_d;
  density.aa = density.twist + a * a * (16 * h_nd + 4 * h_dd);
  density.bb = density.shear + b * b * (-16 * h_nd + 4 * h_dd);
  density.ab = -4 * a * b * h_dd;
  return density;
}

}  // namespace arap
