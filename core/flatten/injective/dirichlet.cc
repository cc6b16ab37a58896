#include "core/flatten/injective/dirichlet.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/flatten/distortion.h"
#include "core/flatten/injective/newton.h"

namespace arap {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

// Of a block of triangles: how far each may go before it is flat, and what it adds to the curvature.
struct AheadBlock {
  KernelColumn limit, curvature;
};

// |α|², |β|² and the determinant are those of newton.h; the determinant is taken from the areas, so
// that thin triangles lose nothing.
ARAP_WIDE_BODY void PullKernel(const DirichletTable& table, std::size_t begin, std::size_t count,
                               ConstShapeView v, CornerPulls& out) {
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t f = begin + k;
    const std::uint32_t i = table.v0[f], j = table.v1[f], l = table.v2[f];
    const double f1x = v.x[j] - v.x[i], f1y = v.y[j] - v.y[i];
    const double f2x = v.x[l] - v.x[i], f2y = v.y[l] - v.y[i];
    const double w1x = table.w1_x[f], w1y = table.w1_y[f];
    const double w2x = table.w2_x[f], w2y = table.w2_y[f];
    const double xx = w1x * f1x + w2x * f2x, yy = w1y * f1y + w2y * f2y;
    const double xy = w1x * f1y + w2x * f2y, yx = w1y * f1x + w2y * f2x;
    const double ax = xx - yy, ay = xy + yx, bx = xx + yy, by = xy - yx;
    const double raw = (f1x * f2y - f1y * f2x) * table.inverse[f];
    const bool upright = raw > 0;
    const double d = upright ? raw : 1;
    const double s1 = std::sqrt(ax * ax + ay * ay) + std::sqrt(bx * bx + by * by);
    const double big = s1 > 0 ? s1 : 1, s2 = d / big;
    const double d1 = big - 1 / big, d2 = s2 - 1 / s2;
    const double norm = big * big + s2 * s2, cube = 1 / (d * d * d);
    const double share = 4 * table.share[f];
    const double twist = share * (1 - (norm - d) * cube);
    const double shear = share * (1 + (norm + d) * cube);
    const double gax = twist * ax, gay = twist * ay, gbx = shear * bx, gby = shear * by;
    out.x1[k] = -(w1x * (gax + gbx) + w1y * (gay - gby));
    out.y1[k] = -(w1x * (gay + gby) + w1y * (gbx - gax));
    out.x2[k] = -(w2x * (gax + gbx) + w2y * (gay - gby));
    out.y2[k] = -(w2x * (gay + gby) + w2y * (gbx - gax));
    out.energy[k] = upright ? table.share[f] * (d1 * d1 + d2 * d2) : kNever;
  }
}

ARAP_WIDE_BODY void LookKernel(const DirichletTable& table, std::size_t begin, std::size_t count,
                               ConstShapeView v, ConstShapeView d, AheadBlock& out) {
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t f = begin + k;
    const std::uint32_t i = table.v0[f], j = table.v1[f], l = table.v2[f];
    const double f1x = v.x[j] - v.x[i], f1y = v.y[j] - v.y[i];
    const double f2x = v.x[l] - v.x[i], f2y = v.y[l] - v.y[i];
    const double g1x = d.x[j] - d.x[i], g1y = d.y[j] - d.y[i];
    const double g2x = d.x[l] - d.x[i], g2y = d.y[l] - d.y[i];
    // The least positive root of c0 + c1·t + c2·t², c0 > 0.
    const double c0 = f1x * f2y - f1y * f2x;
    const double c1 = f1x * g2y - f1y * g2x + g1x * f2y - g1y * f2x;
    const double c2 = g1x * g2y - g1y * g2x;
    const double square = c1 * c1 - 4 * c0 * c2;
    const double under = std::sqrt(square > 0 ? square : 0) - c1;
    const bool meets = square >= 0 && under > 0;
    out.limit[k] = meets ? 2 * c0 / (meets ? under : 1) : kNever;

    const double w1x = table.w1_x[f], w1y = table.w1_y[f];
    const double w2x = table.w2_x[f], w2y = table.w2_y[f];
    const double xx = w1x * f1x + w2x * f2x, yy = w1y * f1y + w2y * f2y;
    const double xy = w1x * f1y + w2x * f2y, yx = w1y * f1x + w2y * f2x;
    const double ax = xx - yy, ay = xy + yx, bx = xx + yy, by = xy - yx;
    const double mxx = w1x * g1x + w2x * g2x, myy = w1y * g1y + w2y * g2y;
    const double mxy = w1x * g1y + w2x * g2y, myx = w1y * g1x + w2y * g2x;
    const double max = mxx - myy, may = mxy + myx, mbx = mxx + myy, mby = mxy - myx;
    const double a = std::sqrt(ax * ax + ay * ay), b = std::sqrt(bx * bx + by * by);
    // Where β is 0 any direction is its own.
    const bool turns = b > 0;
    const double ia = 1 / a, ib = 1 / (turns ? b : 1);
    const double bhx = turns ? bx * ib : 1, bhy = turns ? by * ib : 0;
    const double along_a = (ax * max + ay * may) * ia, across_a = (ax * may - ay * max) * ia;
    const double along_b = bhx * mbx + bhy * mby, across_b = bhx * mby - bhy * mbx;
    const double s1 = a + b, det = c0 * table.inverse[f], s2 = det / s1;
    const double q1 = 1 / (s1 * s1), q2 = 1 / (s2 * s2);
    const double g11 = 2 + 6 * q1 * q1, g22 = 2 + 6 * q2 * q2;
    const double norm = s1 * s1 + s2 * s2, cube = 1 / (det * det * det);
    const double sum = along_a + along_b, difference = along_a - along_b;
    out.curvature[k] = table.share[f] * (g11 * sum * sum + g22 * difference * difference +
                                         4 * (1 - (norm - det) * cube) * across_a * across_a +
                                         4 * (1 + (norm + det) * cube) * across_b * across_b);
  }
}

ARAP_WIDE(PullKernel, PullKernelWide,
          (const DirichletTable& table, std::size_t begin, std::size_t count, ConstShapeView v,
           CornerPulls& out),
          (table, begin, count, v, out))
ARAP_WIDE(LookKernel, LookKernelWide,
          (const DirichletTable& table, std::size_t begin, std::size_t count, ConstShapeView v,
           ConstShapeView d, AheadBlock& out),
          (table, begin, count, v, d, out))

}  // namespace

DirichletPasses::DirichletPasses(const SurfaceMesh& mesh, const std::vector<bool>& left_out,
                                 bool wide)
    : wide_(wide) {
  double total = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!left_out.empty() && left_out[t]) continue;
    const auto& [i, j, k] = mesh.triangles[t];
    const auto rest = LayFlat(mesh, mesh.triangles[t]);
    const double length = rest[1].real(), height = rest[2].imag();
    const Complex d(0, -2 * length * height);
    const Complex w1 = std::conj(rest[2]) / d, w2 = -length / d;
    table_.v0.push_back(i), table_.v1.push_back(j), table_.v2.push_back(k);
    table_.w1_x.push_back(w1.real()), table_.w1_y.push_back(w1.imag());
    table_.w2_x.push_back(w2.real()), table_.w2_y.push_back(w2.imag());
    table_.share.push_back(0.5 * length * height);
    table_.inverse.push_back(1 / (length * height));
    total += table_.share.back();
  }
  for (double& share : table_.share) share /= total;
}

double DirichletPasses::Pull(ConstShapeView v, ShapeView pull, std::size_t vertices) const {
  std::fill_n(pull.x, vertices, 0.0);
  std::fill_n(pull.y, vertices, 0.0);
  const auto kernel = wide_ ? PullKernelWide : PullKernel;
  CornerPulls p;  // NOLINT(*-member-init): written before it is read
  double energy = 0;
  for (std::size_t at = 0; at < table_.size(); at += kKernelBlock) {
    const std::size_t count = std::min(kKernelBlock, table_.size() - at);
    kernel(table_, at, count, v, p);
    energy = AddPulls(table_, at, count, p, energy, pull);
  }
  return energy;
}

DirichletPasses::Ahead DirichletPasses::Look(ConstShapeView v, ConstShapeView d) const {
  const auto kernel = wide_ ? LookKernelWide : LookKernel;
  AheadBlock block;  // NOLINT(*-member-init): likewise
  Ahead ahead{kNever, 0};
  for (std::size_t at = 0; at < table_.size(); at += kKernelBlock) {
    const std::size_t count = std::min(kKernelBlock, table_.size() - at);
    kernel(table_, at, count, v, d, block);
    for (std::size_t k = 0; k < count; ++k) {
      ahead.limit = std::min(ahead.limit, block.limit[k]);
      ahead.curvature += block.curvature[k];
    }
  }
  return ahead;
}

double DirichletPasses::MeanEigenvalue(std::size_t t, ConstShapeView v) const {
  const std::uint32_t i = table_.v0[t], j = table_.v1[t], l = table_.v2[t];
  const Complex f1(v.x[j] - v.x[i], v.y[j] - v.y[i]), f2(v.x[l] - v.x[i], v.y[l] - v.y[i]);
  const Complex w1(table_.w1_x[t], table_.w1_y[t]), w2(table_.w2_x[t], table_.w2_y[t]);
  const double a = std::sqrt(std::norm(w1 * f1 + w2 * f2));
  const double b = std::sqrt(std::norm(std::conj(w1) * f1 + std::conj(w2) * f2));
  const Density density = SymmetricDirichletDensity(a, b);
  return 0.25 * (density.aa + density.bb + std::max(0.0, density.twist) + density.shear);
}

Eigen::SparseMatrix<double> DirichletPasses::Pattern(std::size_t vertices) {
  const int n = static_cast<int>(vertices);
  const auto corners = [this](std::size_t t) {
    return std::array<int, 3>{static_cast<int>(table_.v0[t]), static_cast<int>(table_.v1[t]),
                              static_cast<int>(table_.v2[t])};
  };
  std::vector<Eigen::Triplet<double, int>> entries;
  entries.reserve(3 * table_.size() + vertices);
  for (int v = 0; v < n; ++v) entries.emplace_back(v, v, 0.0);
  for (std::size_t t = 0; t < table_.size(); ++t) {
    const auto c = corners(t);
    for (std::size_t a = 1; a < 3; ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        entries.emplace_back(std::max(c[a], c[b]), std::min(c[a], c[b]), 0.0);
      }
    }
  }
  Eigen::SparseMatrix<double> lower(n, n);
  lower.setFromTriplets(entries.begin(), entries.end());
  lower.makeCompressed();
  const int* begin = lower.outerIndexPtr();
  const int* inner = lower.innerIndexPtr();
  slots_.resize(table_.size());
  for (std::size_t t = 0; t < table_.size(); ++t) {
    const auto c = corners(t);
    std::size_t k = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        const int low = std::min(c[a], c[b]), high = std::max(c[a], c[b]);
        const int* at = std::lower_bound(inner + begin[low], inner + begin[low + 1], high);
        slots_[t][k++] = static_cast<int>(at - inner);
      }
    }
  }
  return lower;
}

void DirichletPasses::Fill(const ConstShapeView* layout, Eigen::SparseMatrix<double>& lower) const {
  // Of 16, 0, 16 and 16.
  constexpr double kIsometry = 12;
  double* values = lower.valuePtr();
  std::fill_n(values, lower.nonZeros(), 0.0);
  for (std::size_t t = 0; t < table_.size(); ++t) {
    const double mean = layout != nullptr ? MeanEigenvalue(t, *layout) : kIsometry;
    const double weight = 2 * mean * table_.share[t];
    const Complex w1(table_.w1_x[t], table_.w1_y[t]), w2(table_.w2_x[t], table_.w2_y[t]);
    const std::array<Complex, 3> w{-(w1 + w2), w1, w2};
    std::size_t k = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        values[slots_[t][k++]] += weight * (w[a] * std::conj(w[b])).real();
      }
    }
  }
}

}  // namespace arap
