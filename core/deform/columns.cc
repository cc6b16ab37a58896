#include "core/deform/columns.h"

#include "core/base/wide.h"

namespace arap {
namespace {

ARAP_WIDE_BODY void AddFour(const ScaledColumn* c, std::size_t begin, std::size_t end, double* x,
                            double* y) {
  const double *z0 = c[0].values, *z1 = c[1].values, *z2 = c[2].values, *z3 = c[3].values;
  const Complex f0 = c[0].factor, f1 = c[1].factor, f2 = c[2].factor, f3 = c[3].factor;
#pragma GCC ivdep
  for (std::size_t v = begin; v < end; ++v) {
    x[v] += (z0[v] * f0.real() + z1[v] * f1.real()) + (z2[v] * f2.real() + z3[v] * f3.real());
    y[v] += (z0[v] * f0.imag() + z1[v] * f1.imag()) + (z2[v] * f2.imag() + z3[v] * f3.imag());
  }
}

ARAP_WIDE(AddFour, AddFourWide,
          (const ScaledColumn* c, std::size_t begin, std::size_t end, double* x, double* y),
          (c, begin, end, x, y))

}  // namespace

void AddColumns(const ScaledColumn* columns, std::size_t count, std::size_t begin, std::size_t end,
                ShapeView shape) {
  std::size_t i = 0;
  for (; i + kColumnGroup <= count; i += kColumnGroup) {
    (HasWide() ? AddFourWide : AddFour)(columns + i, begin, end, shape.x, shape.y);
  }
  for (; i < count; ++i) {
    const Complex factor = columns[i].factor;
    const double* z = columns[i].values;
    for (std::size_t v = begin; v < end; ++v) shape.x[v] += z[v] * factor.real();
    for (std::size_t v = begin; v < end; ++v) shape.y[v] += z[v] * factor.imag();
  }
}

}  // namespace arap
