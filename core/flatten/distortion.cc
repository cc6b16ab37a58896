#include "core/flatten/distortion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/plane.h"
#include "core/mesh/space.h"

namespace arap {
namespace {

constexpr double kCap = 1e30;

// Numbers whose arguments are the angles at the corners, from 0 to π.
std::array<Complex, 3> CornersOf(const std::array<Complex, 3>& p) {
  const std::array<Complex, 3> side{p[1] - p[0], p[2] - p[1], p[0] - p[2]};
  std::array<Complex, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) {
    const Complex a = side[k], b = side[(k + 2) % 3];  // one towards the corner
    const Complex corner(0 - Dot(a, b), std::abs(Cross(a, b)));
    corners[k] = corner == Complex(0) ? Complex(1) : corner;
  }
  return corners;
}

// Largest change of a corner angle, radians.
double AngleChange(const std::array<Complex, 3>& rest, const std::array<Complex, 3>& image) {
  Complex worst(1);
  const auto now = CornersOf(image), before = CornersOf(rest);
  for (std::size_t k = 0; k < 3; ++k) {
    const Complex turn = now[k] * std::conj(before[k]);
    const Complex change(turn.real(), std::abs(turn.imag()));
    // Both point upwards: the farther one lies to the left of the other.
    if (Cross(worst, change) > 0) worst = change;
  }
  return std::atan2(worst.imag(), worst.real());
}

}  // namespace

std::array<double, 2> SingularValues(const std::array<Complex, 3>& rest,
                                     const std::array<Complex, 3>& image) {
  // The map is z ↦ αz + βz̄; its singular values are |α| ± |β|.
  const Complex e1 = rest[1] - rest[0], e2 = rest[2] - rest[0];
  const Complex f1 = image[1] - image[0], f2 = image[2] - image[0];
  const Complex d(0, -2 * Cross(e1, e2));
  const Complex alpha = (f1 * std::conj(e2) - f2 * std::conj(e1)) / d;
  const Complex beta = (e1 * f2 - e2 * f1) / d;
  const double same = std::abs(alpha), mirrored = std::abs(beta);
  return {same + mirrored, same - mirrored};
}

std::array<Complex, 3> LayFlat(const SurfaceMesh& mesh, const Triangle& triangle) {
  const Eigen::Vector3d u = Vec(mesh.vertices[triangle[1]]) - Vec(mesh.vertices[triangle[0]]);
  const Eigen::Vector3d v = Vec(mesh.vertices[triangle[2]]) - Vec(mesh.vertices[triangle[0]]);
  const double length = u.norm();
  return {Complex(0), Complex(length), Complex(u.dot(v) / length, u.cross(v).norm() / length)};
}

TriangleDistortion MeasureTriangle(const std::array<Complex, 3>& rest,
                                   const std::array<Complex, 3>& image) {
  return {SingularValues(rest, image), 0.5 * rest[1].real() * rest[2].imag(),
          AngleChange(rest, image)};
}

Distortion DistortionSum::Zero() {
  Distortion zero;
  zero.symmetric_dirichlet = zero.area_ratio = 0;
  return zero;
}

void DistortionSum::Add(const TriangleDistortion& triangle, double unit, std::uint32_t id) {
  const std::array<double, 2>& s = triangle.singular_values;
  const double area = triangle.area * unit;
  const double s1 = s[0], s2 = std::abs(s[1]);
  total_ += area;
  if (s[1] < 0) ++sum_.flipped;
  sum_.arap_energy += area * ((s[0] - 1) * (s[0] - 1) + (s[1] - 1) * (s[1] - 1));
  sum_.symmetric_dirichlet +=
      area * std::min(kCap, s1 * s1 + s2 * s2 + 1 / (s1 * s1) + 1 / (s2 * s2));
  sum_.area_ratio += area * s1 * s2;
  const double stretch = 100 * std::max(0.0, s1 - 1), compression = 100 * std::max(0.0, 1 - s2);
  sum_.mean_stretch_percent += area * stretch;
  sum_.mean_compression_percent += area * compression;
  sum_.max_stretch_percent = std::max(sum_.max_stretch_percent, stretch);
  sum_.max_compression_percent = std::max(sum_.max_compression_percent, compression);
  const double angle = triangle.angle * 180 / std::numbers::pi;
  sum_.mean_angle_degrees += area * angle;
  sum_.max_angle_degrees = std::max(sum_.max_angle_degrees, angle);
  const double worst = s2 * s1 >= 1 ? s1 : std::min(kCap, 1 / s2);
  if (worst > worst_) {
    worst_ = worst;
    sum_.worst_triangle = id;
  }
}

Distortion DistortionSum::Mean() const {
  Distortion mean = sum_;
  for (double* sum :
       {&mean.arap_energy, &mean.symmetric_dirichlet, &mean.area_ratio, &mean.mean_stretch_percent,
        &mean.mean_compression_percent, &mean.mean_angle_degrees}) {
    *sum /= total_;
  }
  return mean;
}

bool Upright(Complex a, Complex b, Complex c) {
  const Complex u = b - a, v = c - a;
  const double cross = Cross(u, v);
  const auto reach = [](Complex z) { return std::max(std::abs(z.real()), std::abs(z.imag())); };
  const double coordinate = std::max({reach(a), reach(b), reach(c)});
  const double length = std::max(reach(u), reach(v));
  return cross > 4 * std::numeric_limits<double>::epsilon() * coordinate * length &&
         std::isfinite(cross);
}

std::vector<std::uint32_t> NotUpright(std::span<const Triangle> triangles,
                                      std::span<const Complex> uv,
                                      const std::vector<bool>& left_out) {
  std::vector<std::uint32_t> result;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    if (!left_out.empty() && left_out[t]) continue;
    const auto& [a, b, c] = triangles[t];
    if (!Upright(uv[a], uv[b], uv[c])) result.push_back(t);
  }
  return result;
}

std::vector<std::uint32_t> WoundTwice(std::span<const Triangle> triangles,
                                      std::span<const Complex> uv,
                                      const std::vector<bool>& boundary,
                                      const std::vector<bool>& left_out) {
  // A turn around a vertex passes once from below its height to above it, within one of its triangles.
  std::vector<std::uint32_t> turns(uv.size(), 0);
  std::vector<bool> open = boundary;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const bool counts = left_out.empty() || !left_out[t];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = triangles[t][k];
      if (!counts) {
        open[v] = true;
        continue;
      }
      const double height = uv[v].imag();
      const double first = uv[triangles[t][(k + 1) % 3]].imag();
      const double second = uv[triangles[t][(k + 2) % 3]].imag();
      if (first < height && second >= height) ++turns[v];
    }
  }
  std::vector<std::uint32_t> result;
  for (std::uint32_t v = 0; v < uv.size(); ++v) {
    if (!open[v] && turns[v] > 1) result.push_back(v);
  }
  return result;
}

bool LocallyInjective(std::span<const Triangle> triangles, std::span<const Complex> uv,
                      const std::vector<bool>& boundary, const std::vector<bool>& left_out) {
  return NotUpright(triangles, uv, left_out).empty() &&
         WoundTwice(triangles, uv, boundary, left_out).empty();
}

}  // namespace arap
