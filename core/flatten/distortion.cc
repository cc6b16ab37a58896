#include "core/flatten/distortion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace arap {
namespace {

constexpr double kCap = 1e30;

double Angle(Complex a, Complex b) {
  return std::abs(std::atan2(std::imag(std::conj(a) * b), std::real(std::conj(a) * b)));
}

// Largest change of a corner angle, radians.
double AngleChange(const std::array<Complex, 3>& rest, const std::array<Complex, 3>& image) {
  double worst = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    const double before = Angle(rest[i] - rest[k], rest[j] - rest[k]);
    const double after = Angle(image[i] - image[k], image[j] - image[k]);
    worst = std::max(worst, std::abs(after - before));
  }
  return worst;
}

}  // namespace

std::array<double, 2> SingularValues(const std::array<Complex, 3>& rest,
                                     const std::array<Complex, 3>& image) {
  // The map is z ↦ αz + βz̄; its singular values are |α| ± |β|.
  const Complex e1 = rest[1] - rest[0], e2 = rest[2] - rest[0];
  const Complex f1 = image[1] - image[0], f2 = image[2] - image[0];
  const Complex d(0, -2 * std::imag(std::conj(e1) * e2));
  const Complex alpha = (f1 * std::conj(e2) - f2 * std::conj(e1)) / d;
  const Complex beta = (e1 * f2 - e2 * f1) / d;
  return {std::abs(alpha) + std::abs(beta), std::abs(alpha) - std::abs(beta)};
}

std::array<Complex, 3> LayFlat(const SurfaceMesh& mesh, const Triangle& triangle) {
  const Eigen::Vector3d u = mesh.vertices[triangle[1]] - mesh.vertices[triangle[0]];
  const Eigen::Vector3d v = mesh.vertices[triangle[2]] - mesh.vertices[triangle[0]];
  const double length = u.norm();
  return {Complex(0), Complex(length), Complex(u.dot(v) / length, u.cross(v).norm() / length)};
}

Distortion Measure(const SurfaceMesh& mesh, std::span<const Complex> uv,
                   std::vector<std::array<double, 2>>& singular_values) {
  Distortion d;
  d.symmetric_dirichlet = d.area_ratio = 0;
  singular_values.clear();
  double total = 0;
  for (const Triangle& t : mesh.triangles) {
    const auto rest = LayFlat(mesh, t);
    const std::array<Complex, 3> image{uv[t[0]], uv[t[1]], uv[t[2]]};
    const auto s = SingularValues(rest, image);
    singular_values.push_back(s);
    const double area = 0.5 * rest[1].real() * rest[2].imag();
    const double s1 = s[0], s2 = std::abs(s[1]);
    total += area;
    if (s[1] < 0) ++d.flipped;
    d.arap_energy += area * ((s[0] - 1) * (s[0] - 1) + (s[1] - 1) * (s[1] - 1));
    d.symmetric_dirichlet +=
        area * std::min(kCap, s1 * s1 + s2 * s2 + 1 / (s1 * s1) + 1 / (s2 * s2));
    d.area_ratio += area * s1 * s2;
    const double stretch = 100 * std::max(0.0, s1 - 1), compression = 100 * std::max(0.0, 1 - s2);
    d.mean_stretch_percent += area * stretch;
    d.mean_compression_percent += area * compression;
    d.max_stretch_percent = std::max(d.max_stretch_percent, stretch);
    d.max_compression_percent = std::max(d.max_compression_percent, compression);
    const double angle = AngleChange(rest, image) * 180 / std::numbers::pi;
    d.mean_angle_degrees += area * angle;
    d.max_angle_degrees = std::max(d.max_angle_degrees, angle);
  }
  for (double* sum :
       {&d.arap_energy, &d.symmetric_dirichlet, &d.area_ratio, &d.mean_stretch_percent,
        &d.mean_compression_percent, &d.mean_angle_degrees}) {
    *sum /= total;
  }
  return d;
}

}  // namespace arap
