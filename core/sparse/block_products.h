// The products X Xᵀ of dense blocks that a supernodal factor is made of. For this folder only.
//
// A number is the sum of its products from the first column of X to the last, each multiplied and added in one operation
// that rounds once (fma). So it has the same bytes on every processor, whatever registers add up together.
#pragma once

#include <cstddef>
#include <vector>

namespace arap {

// The machine codes of the products; all give the same bytes. The plain one is for processors without fused
// operations, each of which it makes of two dozen others.
enum class ProductCode { kPlain, kAvx2, kAvx512 };
// The fastest of this processor.
ProductCode BestProductCode();

// A dense matrix, column by column; columns begin `stride` numbers apart.
struct BlockView {
  const double* numbers;
  std::size_t stride;
};

// Memory of the machine codes: the product, and copies of the operand that are laid out for the registers.
struct ProductScratch {
  std::vector<double> product, rows, columns;
};

// Makes one product after the other. Not thread-safe.
class BlockProducts {
 public:
  static constexpr std::size_t kMostColumns = 64;

  // For blocks of up to `most_rows` rows.
  BlockProducts(ProductCode code, std::size_t most_rows);

  // X Xᵀ, of which the first `columns` ≤ kMostColumns columns are made, as far as they are on or below the diagonal. X has
  // `rows` rows and `depth` columns.
  void Square(BlockView x, std::size_t rows, std::size_t columns, std::size_t depth) {
    stride_ = square_(x, rows, columns, depth, scratch_);
  }
  // Entry (r, c) of the last product is column(c)[r], for r ≥ c; in odd columns also for r = c − 1.
  const double* column(std::size_t c) const { return scratch_.product.data() + c * stride_; }

 private:
  // Returns how many numbers apart the columns of the product begin.
  using SquareCode = std::size_t (*)(BlockView x, std::size_t rows, std::size_t columns,
                                     std::size_t depth, ProductScratch& scratch);

  SquareCode square_;
  ProductScratch scratch_;
  std::size_t stride_ = 0;
};

}  // namespace arap
