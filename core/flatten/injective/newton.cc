#include "core/flatten/injective/newton.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/plane.h"
#include "core/base/try.h"
#include "core/flatten/distortion.h"

namespace arap {
namespace {

// The projected Hessian does not feel translations, nor rotations of an isometric layout; this
// share of the diagonal makes it definite. Rounding may ask for more.
constexpr double kFirstShift = 1e-11, kLastShift = 1e-2, kMoreShift = 1e3;

struct Map {
  Complex alpha, beta;
  double a = 0, b = 0;
};

Map MapOf(const std::array<std::uint32_t, 3>& corner, const std::array<Complex, 3>& w,
          std::span<const Complex> z) {
  const Complex f1 = z[corner[1]] - z[corner[0]], f2 = z[corner[2]] - z[corner[0]];
  Map map;
  map.alpha = w[1] * f1 + w[2] * f2;
  map.beta = std::conj(w[1]) * f1 + std::conj(w[2]) * f2;
  map.a = std::sqrt(std::norm(map.alpha));
  map.b = std::sqrt(std::norm(map.beta));
  return map;
}

// The symmetric matrix [p r; r q] without its negative eigenvalues.
void KeepPositive(double& p, double& r, double& q) {
  const double mean = 0.5 * (p + q), half = 0.5 * (p - q), radius = std::hypot(half, r);
  const double high = std::max(0.0, mean + radius), low = std::max(0.0, mean - radius);
  if (low == mean - radius || radius == 0) {
    if (high == 0) p = r = q = 0;
    return;
  }
  const double c = half / radius, s = r / radius;  // of twice the angle
  p = 0.5 * (high + low) + 0.5 * (high - low) * c;
  q = 0.5 * (high + low) - 0.5 * (high - low) * c;
  r = 0.5 * (high - low) * s;
}

// Smallest positive root of c0 + c1·t + c2·t², c0 > 0.
double FirstRoot(double c0, double c1, double c2) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const double square = c1 * c1 - 4 * c0 * c2;
  if (square < 0) return kNever;
  const double q = -0.5 * (c1 + std::copysign(std::sqrt(square), c1));
  double first = kNever;
  if (q != 0 && c0 / q > 0) first = c0 / q;
  if (c2 != 0 && q / c2 > 0) first = std::min(first, q / c2);
  return first;
}

// χ without cancellation at negative d.
double Regular(double d, double epsilon) {
  const double root = std::sqrt(d * d + epsilon * epsilon);
  return d > 0 ? 0.5 * (d + root) : 0.5 * epsilon * epsilon / (root - d);
}

}  // namespace

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

Newton Newton::Make(const SurfaceMesh& mesh, std::span<const LayoutPin> pins,
                    const std::vector<bool>& left_out) {
  Newton newton;
  const std::size_t n = mesh.vertices.size();
  double total = 0;
  newton.elements_.reserve(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!left_out.empty() && left_out[t]) continue;
    const auto rest = LayFlat(mesh, mesh.triangles[t]);
    const double l = rest[1].real(), h = rest[2].imag();
    const Complex d(0, -2 * l * h);
    Element element{mesh.triangles[t], {}, 0.5 * l * h};
    element.w[1] = std::conj(rest[2]) / d;
    element.w[2] = -l / d;
    element.w[0] = -(element.w[1] + element.w[2]);
    newton.elements_.push_back(element);
    total += element.area;
  }
  for (Element& element : newton.elements_) element.area /= total;
  newton.fixed_.assign(n, false);
  for (const LayoutPin& pin : pins) {
    if (std::isinf(pin.weight)) {
      newton.fixed_[pin.vertex] = true;
    } else {
      newton.soft_.push_back(pin);
    }
  }
  newton.gradient_.resize(2 * n);
  newton.move_.resize(n);
  return newton;
}

void Newton::MakePattern(std::size_t vertices) {
  using Entry = Eigen::Triplet<double, int>;
  std::vector<Entry> entries;
  entries.reserve(elements_.size() * 21 + 2 * vertices);
  const int n = static_cast<int>(2 * vertices);
  for (int i = 0; i < n; ++i) entries.emplace_back(i, i, 0.0);
  const auto row = [](const Element& e, std::size_t i) {
    return static_cast<int>(2 * e.corner[i / 2] + i % 2);
  };
  for (const Element& e : elements_) {
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        entries.emplace_back(std::max(row(e, i), row(e, j)), std::min(row(e, i), row(e, j)), 0.0);
      }
    }
  }
  hessian_.resize(n, n);
  hessian_.setFromTriplets(entries.begin(), entries.end());
  hessian_.makeCompressed();
  const int* begin = hessian_.outerIndexPtr();
  const int* inner = hessian_.innerIndexPtr();
  const auto slot = [&](int i, int j) {
    const int low = std::min(i, j), high = std::max(i, j);
    return static_cast<int>(std::lower_bound(inner + begin[low], inner + begin[low + 1], high) -
                            inner);
  };
  slots_.resize(elements_.size());
  for (std::size_t t = 0; t < elements_.size(); ++t) {
    const Element& e = elements_[t];
    std::size_t k = 0;
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t j = 0; j <= i; ++j) slots_[t][k++] = slot(row(e, i), row(e, j));
    }
  }
  diagonal_.resize(2 * vertices);
  for (int i = 0; i < n; ++i) diagonal_[static_cast<std::size_t>(i)] = slot(i, i);
}

double Newton::Energy(std::span<const Complex> uv, double epsilon) const {
  double sum = Distortion(uv, epsilon);
  for (const LayoutPin& pin : soft_) sum += pin.weight * std::norm(uv[pin.vertex] - pin.uv);
  return sum;
}

double Newton::Distortion(std::span<const Complex> uv, double epsilon) const {
  double sum = 0;
  for (const Element& e : elements_) {
    const Map map = MapOf(e.corner, e.w, uv);
    sum += e.area *
           (epsilon > 0 ? Untangling(map.a, map.b, epsilon) : SymmetricDirichlet(map.a, map.b));
  }
  return sum;
}

double Newton::BestScale(std::span<const Complex> uv) const {
  double grows = 0, shrinks = 0;
  for (const Element& e : elements_) {
    const Map map = MapOf(e.corner, e.w, uv);
    const double norm = 2 * (map.a * map.a + map.b * map.b);
    const double determinant = (map.a - map.b) * (map.a + map.b);
    grows += e.area * norm;
    shrinks += e.area * norm / (determinant * determinant);
  }
  return std::sqrt(std::sqrt(shrinks / grows));
}

double Newton::MeanDeterminant(std::span<const Complex> uv) const {
  double sum = 0;
  for (const Element& e : elements_) {
    const Map map = MapOf(e.corner, e.w, uv);
    sum += e.area * (map.a - map.b) * (map.a + map.b);
  }
  return sum;
}

double Newton::LeastDeterminant(std::span<const Complex> uv) const {
  double least = std::numeric_limits<double>::infinity();
  for (const Element& e : elements_) {
    const Map map = MapOf(e.corner, e.w, uv);
    least = std::min(least, (map.a - map.b) * (map.a + map.b));
  }
  return least;
}

void Newton::Add(const Element& e, const Slots& slots, std::span<const Complex> uv,
                 double epsilon) {
  const Map map = MapOf(e.corner, e.w, uv);
  Density d = epsilon > 0 ? UntanglingDensity(map.a, map.b, epsilon)
                          : SymmetricDirichletDensity(map.a, map.b);
  const Complex turn_a = map.a > 0 ? std::conj(map.alpha) / map.a : 1;
  const Complex turn_b = map.b > 0 ? std::conj(map.beta) / map.b : 1;
  // How |α|, |β| and their arguments change with the six coordinates.
  std::array<double, 6> a{}, b{}, twist{}, shear{};
  for (std::size_t k = 0; k < 3; ++k) {
    const Complex p = turn_a * e.w[k], q = turn_b * std::conj(e.w[k]);
    a[2 * k] = p.real(), a[2 * k + 1] = -p.imag();
    twist[2 * k] = p.imag(), twist[2 * k + 1] = p.real();
    b[2 * k] = q.real(), b[2 * k + 1] = -q.imag();
    shear[2 * k] = q.imag(), shear[2 * k + 1] = q.real();
  }
  for (std::size_t k = 0; k < 6; ++k) {
    gradient_[2 * e.corner[k / 2] + k % 2] +=
        e.area * (d.twist * map.a * a[k] + d.shear * map.b * b[k]);
  }
  KeepPositive(d.aa, d.ab, d.bb);
  const double aa = e.area * d.aa, ab = e.area * d.ab, bb = e.area * d.bb;
  const double tt = e.area * std::max(0.0, d.twist), ss = e.area * std::max(0.0, d.shear);
  double* values = hessian_.valuePtr();
  std::size_t slot = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    const double x = aa * a[i] + ab * b[i], y = ab * a[i] + bb * b[i];
    const double z = tt * twist[i], s = ss * shear[i];
    for (std::size_t j = 0; j <= i; ++j) {
      values[slots[slot++]] += x * a[j] + y * b[j] + z * twist[j] + s * shear[j];
    }
  }
}

Result<Newton::Step> Newton::Direction(std::span<const Complex> uv, double epsilon) {
  if (!factor_) {
    MakePattern(move_.size());
    TRY(factor_, Factor<double>::Analyse(hessian_, FactorLayout::kSupernodal));
    times_.analysis += factor_->times().analysis;
  }
  std::fill(gradient_.begin(), gradient_.end(), 0.0);
  double* values = hessian_.valuePtr();
  std::fill(values, values + hessian_.nonZeros(), 0.0);
  for (std::size_t t = 0; t < elements_.size(); ++t) Add(elements_[t], slots_[t], uv, epsilon);
  for (const LayoutPin& pin : soft_) {
    const Complex pull = 2 * pin.weight * (uv[pin.vertex] - pin.uv);
    gradient_[2 * pin.vertex] += pull.real();
    gradient_[2 * pin.vertex + 1] += pull.imag();
    for (std::size_t k = 0; k < 2; ++k) {
      values[diagonal_[2 * pin.vertex + k]] += 2 * pin.weight;
    }
  }
  const std::size_t n = diagonal_.size();
  double shift = 0;
  for (double next = kFirstShift;; next *= kMoreShift) {
    for (std::size_t i = 0; i < n; ++i) {
      double& x = values[diagonal_[i]];
      // Nothing pulls at a vertex whose triangles are all left out: it stays.
      x = x > 0 ? x / (1 + shift) * (1 + next) : 1;
    }
    shift = next;
    if (std::find(fixed_.begin(), fixed_.end(), true) != fixed_.end()) {
      const int* begin = hessian_.outerIndexPtr();
      const int* inner = hessian_.innerIndexPtr();
      for (std::size_t j = 0; j < n; ++j) {
        for (int k = begin[j]; k < begin[j + 1]; ++k) {
          const auto i = static_cast<std::size_t>(inner[k]);
          if (i != j && (fixed_[i / 2] || fixed_[j / 2])) values[k] = 0;
        }
        if (fixed_[j / 2]) gradient_[j] = 0;
      }
    }
    auto ok = factor_->Again(hessian_);
    times_.numbers += factor_->times().numbers;
    if (ok) break;
    if (next * kMoreShift > kLastShift) return Fail(std::move(ok.error()));
  }
  TRY(const auto solution, factor_->Solve(gradient_, 1, workspace_));
  Step step{move_, 0};
  for (std::size_t i = 0; i < n; ++i) step.slope -= gradient_[i] * solution[i];
  for (std::size_t v = 0; v < move_.size(); ++v) {
    move_[v] = fixed_[v] ? 0 : -Complex(solution[2 * v], solution[2 * v + 1]);
  }
  return step;
}

double Newton::Limit(std::span<const Complex> uv, std::span<const Complex> move) const {
  double limit = std::numeric_limits<double>::infinity();
  for (const Element& e : elements_) {
    const auto& [i, j, k] = e.corner;
    const Complex f1 = uv[j] - uv[i], f2 = uv[k] - uv[i];
    const Complex g1 = move[j] - move[i], g2 = move[k] - move[i];
    limit = std::min(limit, FirstRoot(Cross(f1, f2), Cross(f1, g2) + Cross(g1, f2), Cross(g1, g2)));
  }
  return limit;
}

}  // namespace arap
