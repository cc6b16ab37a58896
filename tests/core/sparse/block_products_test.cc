// Products of blocks: every number is what std::fma makes of it, in order, by every machine code.
#include "core/sparse/block_products.h"

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace arap::testing {
namespace {

std::vector<ProductCode> CodesHere() {
  std::vector<ProductCode> codes{ProductCode::kPlain};
  const ProductCode best = BestProductCode();
  if (best != ProductCode::kPlain) codes.push_back(ProductCode::kAvx2);
  if (best == ProductCode::kAvx512) codes.push_back(ProductCode::kAvx512);
  return codes;
}

using Numbers = std::function<double(std::mt19937_64& random)>;

void ExpectFused(std::size_t rows, std::size_t columns, std::size_t depth, const Numbers& number) {
  SCOPED_TRACE(fmt::format("{} rows, {} columns, depth {}", rows, columns, depth));
  std::mt19937_64 random(rows + 100 * columns + 10'000 * depth);
  const std::size_t stride = rows + 3;
  std::vector<double> x(stride * depth);
  for (double& value : x) value = number(random);
  for (const ProductCode code : CodesHere()) {
    BlockProducts products(code, rows);
    products.Square({x.data(), stride}, rows, columns, depth);
    for (std::size_t c = 0; c < columns; ++c) {
      for (std::size_t r = c; r < rows; ++r) {
        double sum = 0;
        for (std::size_t k = 0; k < depth; ++k) {
          sum = std::fma(x[r + k * stride], x[c + k * stride], sum);
        }
        const double made = products.column(c)[r];
        if (std::isnan(sum) && std::isnan(made)) continue;
        ASSERT_EQ(std::bit_cast<std::uint64_t>(made), std::bit_cast<std::uint64_t>(sum))
            << "row " << r << ", column " << c << ", code " << static_cast<int>(code);
      }
    }
  }
}

double Any(std::mt19937_64& random) { return std::uniform_real_distribution<>(-1, 1)(random); }

// Few digits, so that sums end in the middle between two numbers, or in 0.
double Short(std::mt19937_64& random) {
  const auto digits = static_cast<double>(random() % 9) - 4;
  return std::ldexp(digits, static_cast<int>(random() % 5) * 27 - 54);
}
// All digits the same, of all sizes.
double Ones(std::mt19937_64& random) {
  const double ones = 1 - std::ldexp(1.0, -static_cast<int>(random() % 53) - 1);
  return std::ldexp(random() % 2 == 0 ? ones : -ones, static_cast<int>(random() % 120) - 60);
}
// Up to where sums overflow and digits get lost.
double Extreme(std::mt19937_64& random) {
  return std::ldexp(Any(random), static_cast<int>(random() % 1100) - 550);
}

TEST(BlockProductsTest, OfAnyNumberOfRowsAndColumns) {
  for (std::size_t rows = 1; rows <= 33; ++rows) {
    for (std::size_t columns = 1; columns <= rows; ++columns) ExpectFused(rows, columns, 3, Any);
  }
}

TEST(BlockProductsTest, LargeEnoughToBePacked) {
  for (const std::size_t rows : std::vector<std::size_t>{48, 49, 71, 72, 73, 130}) {
    for (const std::size_t columns : std::vector<std::size_t>{16, 17, 23, 41, 48}) {
      for (const std::size_t depth : std::vector<std::size_t>{7, 8, 9, 95, 96, 97, 200}) {
        ExpectFused(rows, columns, depth, Any);
      }
    }
  }
  ExpectFused(200, BlockProducts::kMostColumns, 300, Any);
}

TEST(BlockProductsTest, RoundedOnceWhateverTheNumbers) {
  for (const Numbers& numbers : {Numbers(Short), Numbers(Ones), Numbers(Extreme)}) {
    for (std::size_t depth = 1; depth <= 40; ++depth) ExpectFused(37, 12, depth, numbers);
    ExpectFused(150, 40, 150, numbers);
  }
}

TEST(BlockProductsTest, BothSidesOfWhereThePlainCodeEmulates) {
  // At its limits, and beyond them; with numbers without full precision, and some that are none.
  for (const int exponent : {-1074, -1022, -540, -401, -400, -399, 399, 400, 401, 511, 1023}) {
    SCOPED_TRACE(exponent);
    ExpectFused(21, 9, 13, [exponent](std::mt19937_64& random) {
      return random() % 3 == 0 ? std::ldexp(Any(random), exponent) : Any(random);
    });
  }
  ExpectFused(21, 9, 13, [](std::mt19937_64& random) {
    return random() % 50 == 0 ? std::nan("") : random() % 50 == 1 ? HUGE_VAL : Any(random);
  });
  ExpectFused(21, 9, 13, [](std::mt19937_64& random) {
    return random() % 2 == 0 ? -0.0 : random() % 2 == 0 ? 0.0 : Any(random);
  });
}

}  // namespace
}  // namespace arap::testing
