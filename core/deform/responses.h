// Responses: Z = G Cᴴ, how the grounded mesh answers each constraint row. One back-substitution a
// row, reused by every edit that keeps the row.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "arap/base/cancel.h"
#include "core/deform/place.h"
#include "core/deform/registered_parts.h"

namespace arap {

// Copies share their columns.
class Responses {
 public:
  // How the mesh answers one row, per vertex (#V each): in step 1, split in real and imaginary
  // parts so that adding one is two plain loops, and in step 2.
  struct Column {
    std::vector<double> similarity_real, similarity_imag, rigid;
  };

  std::size_t rows() const { return columns_.size(); }
  // Shared columns count in full.
  std::size_t bytes() const;

  const Column& of(std::size_t row) const { return *columns_[row]; }

  // Those of the given rows only.
  Responses Select(const std::vector<std::size_t>& rows) const;

  // Appends the responses of `added`. Asks `cancel` between blocks of columns.
  Status Append(const RegisteredMeshParts& mesh, const std::vector<Row>& added,
                const CancelToken& cancel);

 private:
  std::vector<std::shared_ptr<const Column>> columns_;
};

}  // namespace arap
