#include "core/sparse/block_products.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/base/lanes.h"
#include "core/base/wide.h"

namespace arap {
namespace {

#define ARAP_INLINE [[gnu::always_inline]] inline

// Ways to multiply and add: Left is what Load makes of neighbouring numbers, or Fill of one for all lanes; Right is what
// LoadOne makes of one, and Add is sum := left·right + sum, rounded once if IsSure at the end.

// The processor's own.
template <std::size_t kLanes>
class Fused {
 public:
  using Left = Lanes<kLanes>;
  using Right = double;
  ARAP_INLINE static void Load(const double* x, Left& left) {
    left = *reinterpret_cast<const Left*>(x);
  }
  ARAP_INLINE static void LoadOne(const double* y, Right& right) {
    // Or neighbours are loaded together and then spread over registers, which takes longer than to load each.
    asm("" : "+r"(y));
    right = *y;
  }
  ARAP_INLINE static void Fill(double x, Left& left) { left = Left{} + x; }
  ARAP_INLINE static void Add(const Left& left, const Right& right, Lanes<kLanes>& sum) {
    AddLanes(left, right, sum, std::make_index_sequence<kLanes>());
  }
  static constexpr bool IsSure() { return true; }

 private:
  // In this form compilers make one instruction of it.
  template <std::size_t... kLane>
  ARAP_INLINE static void AddLanes(const Left& left, const Right& right, Lanes<kLanes>& sum,
                                   std::index_sequence<kLane...> /*lanes*/) {
    sum = Lanes<kLanes>{__builtin_fma(left[kLane], right, sum[kLane])...};
  }
};

// Out of operations that round each by themselves: the product and the sum are taken apart without error, and what the sum
// of the two small parts may have lost is asked for at the end. Right as long as IsSure, while numbers are AreModerate.
template <std::size_t kLanes>
class Emulated {
 public:
  static_assert(kLanes == 2);
  // A number, and the halves of its digits.
  struct Halves {
    Pair whole, high, low;
  };
  using Left = Halves;
  using Right = Halves;

  ARAP_INLINE static void Load(const double* x, Left& left) {
    Split(*reinterpret_cast<const Pair*>(x), left);
  }
  ARAP_INLINE static void LoadOne(const double* y, Right& right) { Split(Pair{*y, *y}, right); }
  ARAP_INLINE static void Fill(double x, Left& left) { Split(Pair{x, x}, left); }
  ARAP_INLINE void Add(const Left& left, const Right& right, Pair& sum) {
    const Pair product = left.whole * right.whole;
    const Pair rest =
        ((left.high * right.high - product) + left.high * right.low + left.low * right.high) +
        left.low * right.low;
    const Pair large = product + sum, of_sum = large - product;
    const Pair lost = (product - (large - of_sum)) + (sum - of_sum), small = lost + rest;
    // The true small part is between these two; it is `small` itself where the sum has lost nothing, as when it cancels.
    const Pair more = large + small * (1 + 0x1p-50), less = large + small * (1 - 0x1p-50);
    doubt_ |= (reinterpret_cast<Bits>(more) ^ reinterpret_cast<Bits>(less)) &
              reinterpret_cast<Bits>(lost != 0);
    sum = large + small;
  }
  bool IsSure() const { return (doubt_[0] | doubt_[1]) == 0; }

 private:
  // NOLINTNEXTLINE(modernize-use-using): as in lanes.h
  typedef std::uint64_t Bits __attribute__((vector_size(16), may_alias));

  ARAP_INLINE static void Split(const Pair& x, Halves& halves) {
    constexpr double kHalf = 134217729;  // 2^27 + 1
    const Pair up = x * kHalf;
    halves.whole = x;
    halves.high = up - (up - x);
    halves.low = x - halves.high;
  }

  Bits doubt_{};
};

// product (kVectors·kLanes × kColumns) := X Yᵀ, or += with `more`. A column of X begins x_stride numbers after the one
// before it. Returns whether the numbers are right for sure, as do all of these.
template <template <std::size_t> class Code, std::size_t kLanes, std::size_t kVectors,
          std::size_t kColumns>
ARAP_INLINE bool Tile(const double* x, std::size_t x_stride, const double* y, std::size_t y_stride,
                      std::size_t depth, double* product, std::size_t stride, bool more) {
  using Ops = Code<kLanes>;
  Ops ops;
  Lanes<kLanes> sum[kColumns][kVectors]{};
#pragma GCC unroll 8
  for (std::size_t c = 0; c < kColumns; ++c) {
#pragma GCC unroll 8
    for (std::size_t v = 0; v < kVectors; ++v) {
      if (more) {
        sum[c][v] = *reinterpret_cast<const Lanes<kLanes>*>(product + c * stride + v * kLanes);
      }
    }
  }
  for (std::size_t k = 0; k < depth; ++k, x += x_stride, y += y_stride) {
    typename Ops::Left left[kVectors];
#pragma GCC unroll 8
    for (std::size_t v = 0; v < kVectors; ++v) Ops::Load(x + v * kLanes, left[v]);
#pragma GCC unroll 8
    for (std::size_t c = 0; c < kColumns; ++c) {
      typename Ops::Right right;
      Ops::LoadOne(y + c, right);
#pragma GCC unroll 8
      for (std::size_t v = 0; v < kVectors; ++v) ops.Add(left[v], right, sum[c][v]);
    }
  }
#pragma GCC unroll 8
  for (std::size_t c = 0; c < kColumns; ++c) {
#pragma GCC unroll 8
    for (std::size_t v = 0; v < kVectors; ++v) {
      *reinterpret_cast<Lanes<kLanes>*>(product + c * stride + v * kLanes) = sum[c][v];
    }
  }
  return ops.IsSure();
}

// The square of a block of one row.
template <class Ops>
ARAP_INLINE bool SingleNumber(BlockView x, std::size_t depth, double& square) {
  Ops ops;
  Pair sum{};
  for (std::size_t k = 0; k < depth; ++k) {
    typename Ops::Left left;
    typename Ops::Right right;
    Ops::Fill(x.numbers[k * x.stride], left);
    Ops::LoadOne(x.numbers + k * x.stride, right);
    ops.Add(left, right, sum);
  }
  square = sum[0];
  return ops.IsSure();
}

// kColumns columns of X Xᵀ from column c on, for an X that is not packed. Where the rows do not fill the last register, it
// begins above, and makes numbers again or such as nobody needs.
template <template <std::size_t> class Code, std::size_t kLanes, std::size_t kVectors,
          std::size_t kColumns>
ARAP_INLINE bool Strip(BlockView x, std::size_t c, std::size_t rows, std::size_t depth,
                       double* product) {
  const double* const y = x.numbers + c;
  double* const out = product + c * rows;
  if (rows < kLanes) {
    if constexpr (kLanes > 2) {
      return Strip<Code, kLanes / 2, 1, kColumns>(x, c, rows, depth, product);
    } else {
      return SingleNumber<Code<2>>(x, depth, *product);
    }
  }
  bool sure = true;
  const auto tile = [&]<std::size_t kWide>(std::size_t r) __attribute__((always_inline)) {
    sure &= Tile<Code, kLanes, kWide, kColumns>(x.numbers + r, x.stride, y, x.stride, depth,
                                                out + r, rows, false);
  };
  std::size_t r = c;
  for (; r + kLanes * kVectors <= rows; r += kLanes * kVectors) {
    tile.template operator()<kVectors>(r);
  }
  if constexpr (kVectors > 1) {
    for (; r + kLanes <= rows; r += kLanes) tile.template operator()<1>(r);
  }
  if (r < rows) tile.template operator()<1>(rows - kLanes);
  return sure;
}

template <template <std::size_t> class Code, std::size_t kLanes, std::size_t kVectors>
ARAP_INLINE bool SmallSquare(BlockView x, std::size_t rows, std::size_t columns, std::size_t depth,
                             double* product) {
  bool sure = true;
  const auto strip = [&]<std::size_t kColumns>(std::size_t c) __attribute__((always_inline)) {
    sure &= Strip<Code, kLanes, kVectors, kColumns>(x, c, rows, depth, product);
  };
  std::size_t c = 0;
  for (; c + 4 <= columns; c += 4) strip.template operator()<4>(c);
  if (columns - c == 3) strip.template operator()<3>(c);
  if (columns - c == 2) strip.template operator()<2>(c);
  if (columns - c == 1) strip.template operator()<1>(c);
  return sure;
}

// Columns of X that are taken at a time where it is packed: a piece of kRows rows stays in the first cache.
constexpr std::size_t kDepth = 96;

// Up to kRows rows and `depth` columns of X, side by side and filled up with 0.
template <std::size_t kRows>
ARAP_INLINE void Pack(const double* x, std::size_t stride, std::size_t rows, std::size_t depth,
                      double* out) {
  for (std::size_t k = 0; k < depth; ++k, x += stride, out += kRows) {
    if (rows >= kRows) {
      for (std::size_t r = 0; r < kRows; ++r) out[r] = x[r];
    } else {
      for (std::size_t r = 0; r < kRows; ++r) out[r] = r < rows ? x[r] : 0;
    }
  }
}

// The same for an X that is worth packing: it is read from the caches, in order. Returns the stride of the product.
template <template <std::size_t> class Code, std::size_t kLanes, std::size_t kVectors,
          std::size_t kColumns>
ARAP_INLINE std::size_t LargeSquare(BlockView x, std::size_t rows, std::size_t columns,
                                    std::size_t depth, ProductScratch& scratch) {
  constexpr std::size_t kRows = kLanes * kVectors;
  const std::size_t stride = (rows + kRows - 1) / kRows * kRows;
  for (std::size_t k = 0; k < depth; k += kDepth) {
    const std::size_t count = std::min(kDepth, depth - k);
    const double* const from = x.numbers + k * x.stride;
    double* const y = scratch.columns.data();
    for (std::size_t c = 0; c < columns; c += kColumns) {
      Pack<kColumns>(from + c, x.stride, rows - c, count, y + c * count);
    }
    for (std::size_t r = 0; r < rows; r += kRows) {
      Pack<kRows>(from + r, x.stride, rows - r, count, scratch.rows.data());
      for (std::size_t c = 0; c < columns && c < r + kRows; c += kColumns) {
        Tile<Code, kLanes, kVectors, kColumns>(scratch.rows.data(), kRows, y + c * count, kColumns,
                                               count, scratch.product.data() + c * stride + r,
                                               stride, k > 0);
      }
    }
  }
  return stride;
}

// Packing X costs as much as a few columns of a product.
[[maybe_unused]] bool IsLarge(std::size_t rows, std::size_t columns, std::size_t depth) {
  return rows >= 48 && columns >= 16 && depth >= 8;
}

// Whether products of these numbers are far from the smallest and the largest there are.
[[maybe_unused]] bool AreModerate(BlockView x, std::size_t rows, std::size_t depth) {
  constexpr double kLeast = 0x1p-400, kMost = 0x1p400;
  for (std::size_t k = 0; k < depth; ++k) {
    const double* column = x.numbers + k * x.stride;
    bool moderate = true;
    for (std::size_t r = 0; r < rows; ++r) {
      const double size = std::abs(column[r]);
      moderate &= size == 0 || (size >= kLeast && size <= kMost);
    }
    if (!moderate) return false;
  }
  return true;
}

// With the library's fma, which takes the processor's where there is one, and else its time.
void SquareOfAnyNumbers(BlockView x, std::size_t rows, std::size_t columns, std::size_t depth,
                        double* product) {
  for (std::size_t c = 0; c < columns; ++c) {
    for (std::size_t r = c & ~std::size_t{1}; r < rows; ++r) {
      double sum = 0;
      for (std::size_t k = 0; k < depth; ++k) {
        sum = std::fma(x.numbers[r + k * x.stride], x.numbers[c + k * x.stride], sum);
      }
      product[c * rows + r] = sum;
    }
  }
}

std::size_t SquarePlain(BlockView x, std::size_t rows, std::size_t columns, std::size_t depth,
                        ProductScratch& scratch) {
#ifdef __clang__
  // See wide.h: no lanes.
  SquareOfAnyNumbers(x, rows, columns, depth, scratch.product.data());
#elif defined(__FP_FAST_FMA)
  SmallSquare<Fused, 2, 2>(x, rows, columns, depth, scratch.product.data());
#else
  if (!AreModerate(x, rows, depth) ||
      !SmallSquare<Emulated, 2, 2>(x, rows, columns, depth, scratch.product.data())) {
    SquareOfAnyNumbers(x, rows, columns, depth, scratch.product.data());
  }
#endif
  return rows;
}

#ifdef ARAP_HAS_WIDE
[[gnu::target("avx2,fma")]] std::size_t SquareWide(BlockView x, std::size_t rows,
                                                   std::size_t columns, std::size_t depth,
                                                   ProductScratch& scratch) {
  if (IsLarge(rows, columns, depth)) {
    return LargeSquare<Fused, 4, 3, 4>(x, rows, columns, depth, scratch);
  }
  SmallSquare<Fused, 4, 2>(x, rows, columns, depth, scratch.product.data());
  return rows;
}
[[gnu::target("avx512f,fma")]] std::size_t SquareWidest(BlockView x, std::size_t rows,
                                                        std::size_t columns, std::size_t depth,
                                                        ProductScratch& scratch) {
  if (IsLarge(rows, columns, depth)) {
    return LargeSquare<Fused, 8, 3, 8>(x, rows, columns, depth, scratch);
  }
  SmallSquare<Fused, 8, 2>(x, rows, columns, depth, scratch.product.data());
  return rows;
}
#endif

}  // namespace

ProductCode BestProductCode() {
#ifdef ARAP_HAS_WIDE
  if (__builtin_cpu_supports("fma")) {
    if (__builtin_cpu_supports("avx512f")) return ProductCode::kAvx512;
    if (__builtin_cpu_supports("avx2")) return ProductCode::kAvx2;
  }
#endif
  return ProductCode::kPlain;
}

BlockProducts::BlockProducts(ProductCode code, std::size_t most_rows) : square_(SquarePlain) {
#ifdef ARAP_HAS_WIDE
  if (code == ProductCode::kAvx512) square_ = SquareWidest;
  if (code == ProductCode::kAvx2) square_ = SquareWide;
#else
  static_cast<void>(code);
#endif
  constexpr std::size_t kMostRows = 24;  // of a piece
  scratch_.product.resize((most_rows + kMostRows) * kMostColumns);
  scratch_.rows.resize(kMostRows * kDepth);
  scratch_.columns.resize(kMostColumns * kDepth);
}

}  // namespace arap
