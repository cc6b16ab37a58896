#include "core/flatten/injective/dirichlet.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/lanes.h"
#include "core/flatten/distortion.h"
#include "core/flatten/injective/newton.h"
#include "core/sparse/lower_sum.h"

namespace arap {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

// A complex number is two doubles in a row, says the standard.
const double* NumbersOf(std::span<const Complex> points) {
  return reinterpret_cast<const double*>(points.data());
}
double* NumbersOf(std::span<Complex> points) { return reinterpret_cast<double*>(points.data()); }

ARAP_WIDE_BODY double LargerOf(double a, double b) { return a > b ? a : b; }

// The corners of a block of triangles.
struct CornersOf {
  KernelColumn x0, y0, x1, y1, x2, y2;
};

template <std::size_t kLanes>
ARAP_WIDE_BODY void GatherPoints(const double* points, const std::int32_t* at, std::size_t count,
                                 double* x, double* y) {
  std::size_t k = 0;
  for (; k + kLanes <= count; k += kLanes) {
    Gather<kLanes, 1, PointsBy::kNumber>(points, at + k, *reinterpret_cast<Lanes<kLanes>*>(x + k),
                                         *reinterpret_cast<Lanes<kLanes>*>(y + k));
  }
  for (; k < count; ++k) {
    const Pair& point = PointAt<PointsBy::kNumber>(points, at[k]);
    x[k] = point[0];
    y[k] = point[1];
  }
}

template <std::size_t kLanes>
ARAP_WIDE_BODY void PullKernel(const DirichletTable& table, std::size_t begin, std::size_t count,
                               const double* v, CornerPulls& out) {
  CornersOf c;  // NOLINT(*-member-init): written before it is read
  GatherPoints<kLanes>(v, table.v0.data() + begin, count, c.x0.data(), c.y0.data());
  GatherPoints<kLanes>(v, table.v1.data() + begin, count, c.x1.data(), c.y1.data());
  GatherPoints<kLanes>(v, table.v2.data() + begin, count, c.x2.data(), c.y2.data());
  // As Upright says it.
  constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t f = begin + k;
    const double x0 = c.x0[k], y0 = c.y0[k], x1 = c.x1[k], y1 = c.y1[k], x2 = c.x2[k], y2 = c.y2[k];
    const double f1x = x1 - x0, f1y = y1 - y0, f2x = x2 - x0, f2y = y2 - y0;
    const double coordinate = LargerOf(
        LargerOf(LargerOf(std::abs(x0), std::abs(y0)), LargerOf(std::abs(x1), std::abs(y1))),
        LargerOf(std::abs(x2), std::abs(y2)));
    const double length =
        LargerOf(LargerOf(std::abs(f1x), std::abs(f1y)), LargerOf(std::abs(f2x), std::abs(f2y)));
    const double cross = f1x * f2y - f1y * f2x;
    const bool upright = cross > kRounding * coordinate * length;
    const double w1x = table.w1_x[f], w1y = table.w1_y[f];
    const double w2x = table.w2_x[f], w2y = table.w2_y[f];
    const double xx = w1x * f1x + w2x * f2x, yy = w1y * f1y + w2y * f2y;
    const double xy = w1x * f1y + w2x * f2y, yx = w1y * f1x + w2y * f2x;
    const double ax = xx - yy, ay = xy + yx, bx = xx + yy, by = xy - yx;
    const double share = table.share[f];
    // The determinant is taken from the areas, so that thin triangles lose nothing.
    const double raw = cross * table.inverse[f], d = upright ? raw : 1;
    const double i = 1 / d, i2 = i * i, b4 = 4 * (bx * bx + by * by), b4i3 = b4 * (i * i2);
    const double twist = 4 * share * ((1 - i2) - b4i3);
    const double shear = 4 * share * ((1 + 3 * i2) + b4i3);
    const double gax = twist * ax, gay = twist * ay, gbx = shear * bx, gby = shear * by;
    out.x1[k] = -(w1x * (gax + gbx) + w1y * (gay - gby));
    out.y1[k] = -(w1x * (gay + gby) + w1y * (gbx - gax));
    out.x2[k] = -(w2x * (gax + gbx) + w2y * (gay - gby));
    out.y2[k] = -(w2x * (gay + gby) + w2y * (gbx - gax));
    const double energy = share * (b4 * (1 + i2) + 2 * (d - 1) * (d - 1) * i);
    out.energy[k] = upright ? energy : kNever;
  }
}

// From the first corner to the others, in a layout and in a direction.
struct EdgesAhead {
  KernelColumn f1x, f1y, f2x, f2y, g1x, g1y, g2x, g2y;
};

template <std::size_t kLanes>
ARAP_WIDE_BODY void LookKernel(const DirichletTable& table, std::size_t begin, std::size_t count,
                               const double* v, const double* d, double& nearest,
                               double& curvature) {
  EdgesAhead e;                            // NOLINT(*-member-init): likewise
  KernelColumn inverse_limit, curvatures;  // NOLINT(*-member-init): likewise
  GatherEdges<kLanes, 1, PointsBy::kNumber>(
      v, table.v0.data() + begin, {table.v1.data() + begin, table.v2.data() + begin}, count,
      {e.f1x.data(), e.f2x.data()}, {e.f1y.data(), e.f2y.data()});
  GatherEdges<kLanes, 1, PointsBy::kNumber>(
      d, table.v0.data() + begin, {table.v1.data() + begin, table.v2.data() + begin}, count,
      {e.g1x.data(), e.g2x.data()}, {e.g1y.data(), e.g2y.data()});
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t f = begin + k;
    const double f1x = e.f1x[k], f1y = e.f1y[k], f2x = e.f2x[k], f2y = e.f2y[k];
    const double g1x = e.g1x[k], g1y = e.g1y[k], g2x = e.g2x[k], g2y = e.g2y[k];
    // The determinant along the way is c0 + c1·t + c2·t², c0 > 0.
    const double area = table.inverse[f];
    const double c0 = area * (f1x * f2y - f1y * f2x);
    const double c1 = area * ((f1x * g2y - f1y * g2x) + (g1x * f2y - g1y * f2x));
    const double c2 = area * (g1x * g2y - g1y * g2x);
    const double i = 1 / c0, i2 = i * i, i3 = i * i2;
    // Twice one over its least positive root.
    const double square = c1 * c1 - 4 * c0 * c2;
    const double under = (std::sqrt(square > 0 ? square : 0) - c1) * i;
    inverse_limit[k] = square >= 0 ? LargerOf(under, 0) : 0;

    // E = 4B(1 + 1/D²) + 2D + 2/D − 4 with B = |β|², and B and D are quadratic in t.
    const double w1x = table.w1_x[f], w1y = table.w1_y[f];
    const double w2x = table.w2_x[f], w2y = table.w2_y[f];
    const double bx = (w1x * f1x + w2x * f2x) + (w1y * f1y + w2y * f2y);
    const double by = (w1x * f1y + w2x * f2y) - (w1y * f1x + w2y * f2x);
    const double mx = (w1x * g1x + w2x * g2x) + (w1y * g1y + w2y * g2y);
    const double my = (w1x * g1y + w2x * g2y) - (w1y * g1x + w2y * g2x);
    const double b4 = 4 * (bx * bx + by * by), turn = bx * mx + by * my;
    curvatures[k] =
        table.share[f] * (8 * (1 + i2) * (mx * mx + my * my) + 4 * c2 * ((1 - i2) - b4 * i3) +
                          i3 * c1 * (c1 * (4 + 6 * (b4 * i)) - 32 * turn));
  }
  nearest = LargestOf(inverse_limit.data(), count);
  curvature = SumOf(curvatures.data(), count);
}

// NOLINTBEGIN(bugprone-macro-parentheses): these are no expressions
#define ARAP_DIRICHLET_TWINS(name, parameters, arguments) \
  void name##Plain parameters { name<2> arguments; }      \
  ARAP_WIDE(name<4>, name##Wide, parameters, arguments)   \
  ARAP_WIDEST(name<8>, name##Widest, parameters, arguments)
// NOLINTEND(bugprone-macro-parentheses)
ARAP_DIRICHLET_TWINS(PullKernel,
                     (const DirichletTable& table, std::size_t begin, std::size_t count,
                      const double* v, CornerPulls& out),
                     (table, begin, count, v, out))
ARAP_DIRICHLET_TWINS(LookKernel,
                     (const DirichletTable& table, std::size_t begin, std::size_t count,
                      const double* v, const double* d, double& nearest, double& curvature),
                     (table, begin, count, v, d, nearest, curvature))
#undef ARAP_DIRICHLET_TWINS

// A triangle's two stiffnesses, and the direction of the first one, squared.
struct Stiffness {
  double sum, difference;
  Complex direction;
};

Stiffness StiffnessOf(Complex alpha, Complex beta) {
  const double a = std::sqrt(std::norm(alpha)), b = std::sqrt(std::norm(beta));
  const Density density = SymmetricDirichletDensity(a, b);
  // What moves across a direction is half turn, half shear.
  const double across = 0.25 * (std::max(0.0, density.twist) + density.shear);
  const bool stretched = b > 0;
  return {0.5 * density.aa + across, stretched ? 0.5 * density.ab : 0,
          stretched ? beta * std::conj(alpha) / (a * b) : 1};
}

}  // namespace

std::span<const DirichletKernels> DirichletKernelsHere() {
  static constexpr DirichletKernels kAll[] = {{PullKernelPlain, LookKernelPlain},
                                              {PullKernelWide, LookKernelWide},
                                              {PullKernelWidest, LookKernelWidest}};
  static const std::size_t kHave = HasWide() ? HasWidest() ? 3 : 2 : 1;
  return std::span(kAll).first(kHave);
}

DirichletPasses::DirichletPasses(const SurfaceMesh& mesh, const std::vector<bool>& left_out,
                                 const DirichletKernels& kernels)
    : kernels_(kernels) {
  const std::size_t count = mesh.triangles.size();
  for (auto* column : {&table_.v0, &table_.v1, &table_.v2}) column->reserve(count);
  for (auto* column :
       {&table_.w1_x, &table_.w1_y, &table_.w2_x, &table_.w2_y, &table_.share, &table_.inverse}) {
    column->reserve(count);
  }
  double total = 0;
  for (std::size_t t = 0; t < count; ++t) {
    if (!left_out.empty() && left_out[t]) continue;
    const auto& [i, j, k] = mesh.triangles[t];
    const auto rest = LayFlat(mesh, mesh.triangles[t]);
    const double length = rest[1].real(), height = rest[2].imag();
    const Complex d(0, -2 * length * height);
    const Complex w1 = std::conj(rest[2]) / d, w2 = -length / d;
    table_.v0.push_back(static_cast<std::int32_t>(i));
    table_.v1.push_back(static_cast<std::int32_t>(j));
    table_.v2.push_back(static_cast<std::int32_t>(k));
    table_.w1_x.push_back(w1.real()), table_.w1_y.push_back(w1.imag());
    table_.w2_x.push_back(w2.real()), table_.w2_y.push_back(w2.imag());
    table_.share.push_back(0.5 * length * height);
    table_.inverse.push_back(1 / (length * height));
    total += table_.share.back();
  }
  for (double& share : table_.share) share /= total;
}

double DirichletPasses::Pull(std::span<const Complex> v, std::span<Complex> pull) const {
  std::fill(pull.begin(), pull.end(), 0.0);
  double* numbers = NumbersOf(pull);
  CornerPulls p;  // NOLINT(*-member-init): written before it is read
  double energy = 0;
  for (std::size_t at = 0; at < table_.size(); at += kKernelBlock) {
    const std::size_t count = std::min(kKernelBlock, table_.size() - at);
    kernels_.pull(table_, at, count, NumbersOf(v), p);
    for (std::size_t k = 0; k < count; ++k) {
      const Pair second{p.x1[k], p.y1[k]}, third{p.x2[k], p.y2[k]};
      PointAt<PointsBy::kNumber>(numbers, table_.v0[at + k]) -= second + third;
      PointAt<PointsBy::kNumber>(numbers, table_.v1[at + k]) += second;
      PointAt<PointsBy::kNumber>(numbers, table_.v2[at + k]) += third;
    }
    energy += SumOf(p.energy.data(), count);
  }
  return energy;
}

DirichletPasses::Ahead DirichletPasses::Look(std::span<const Complex> v,
                                             std::span<const Complex> d) const {
  double nearest = 0, curvature = 0;
  for (std::size_t at = 0; at < table_.size(); at += kKernelBlock) {
    const std::size_t count = std::min(kKernelBlock, table_.size() - at);
    double near = 0, bend = 0;
    kernels_.look(table_, at, count, NumbersOf(v), NumbersOf(d), near, bend);
    nearest = std::max(nearest, near);
    curvature += bend;
  }
  return {nearest > 0 ? 2 / nearest : kNever, curvature};
}

Eigen::SparseMatrix<double> DirichletPasses::Pattern(std::size_t vertices) {
  const std::vector<bool> none(vertices, false);
  LowerSum<double> sum(none);
  const auto corners = [this](std::size_t t) {
    return std::array<std::uint32_t, 3>{static_cast<std::uint32_t>(table_.v0[t]),
                                        static_cast<std::uint32_t>(table_.v1[t]),
                                        static_cast<std::uint32_t>(table_.v2[t])};
  };
  const auto for_each_side = [&](auto visit) {
    for (std::size_t t = 0; t < table_.size(); ++t) {
      const auto [i, j, k] = corners(t);
      visit(std::max(i, j), std::min(i, j));
      visit(std::max(j, k), std::min(j, k));
      visit(std::max(k, i), std::min(k, i));
    }
  };
  for_each_side([&](std::uint32_t row, std::uint32_t column) { sum.Count(row, column); });
  sum.EndOfCounting();
  for_each_side([&](std::uint32_t row, std::uint32_t column) { sum.Add(row, column, 0); });
  Eigen::SparseMatrix<double> lower = sum.Take();
  const int* begin = lower.outerIndexPtr();
  const int* inner = lower.innerIndexPtr();
  slots_.resize(table_.size());
  for (std::size_t t = 0; t < table_.size(); ++t) {
    const auto c = corners(t);
    std::size_t k = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        const std::uint32_t low = std::min(c[a], c[b]), high = std::max(c[a], c[b]);
        const int* at =
            std::lower_bound(inner + begin[low], inner + begin[low + 1], static_cast<int>(high));
        slots_[t][k++] = static_cast<int>(at - inner);
      }
    }
  }
  return lower;
}

void DirichletPasses::Fill(std::span<const Complex> layout,
                           Eigen::SparseMatrix<double>& lower) const {
  double* values = lower.valuePtr();
  std::fill_n(values, lower.nonZeros(), 0.0);
  for (std::size_t t = 0; t < table_.size(); ++t) {
    const Complex w1(table_.w1_x[t], table_.w1_y[t]), w2(table_.w2_x[t], table_.w2_y[t]);
    Stiffness own{12, 0, 1};  // of an isometry: the mean of 16, 0, 16 and 16
    if (!layout.empty()) {
      const auto point = [&](std::int32_t v) { return layout[static_cast<std::size_t>(v)]; };
      const Complex first = point(table_.v0[t]);
      const Complex f1 = point(table_.v1[t]) - first, f2 = point(table_.v2[t]) - first;
      own = StiffnessOf(w1 * f1 + w2 * f2, std::conj(w1) * f1 + std::conj(w2) * f2);
    }
    const double sum = 2 * table_.share[t] * own.sum;
    const Complex turned = 2 * table_.share[t] * own.difference * own.direction;
    const std::array<Complex, 3> w{-(w1 + w2), w1, w2};
    std::size_t k = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const Complex alike = sum * std::conj(w[a]) + turned * w[a];
      for (std::size_t b = 0; b <= a; ++b) {
        values[slots_[t][k++]] += (alike * w[b]).real();
      }
    }
  }
}

}  // namespace arap
