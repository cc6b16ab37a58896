// Responses: Z = G Cᴴ, how the grounded mesh answers each constraint row. One back-substitution a
// row, reused by every edit that keeps the row.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "core/base/cancel.h"
#include "core/deform/place.h"
#include "core/deform/registered_parts.h"

namespace arap {

class Responses {
 public:
  std::size_t rows() const { return static_cast<std::size_t>(rigid_.cols()); }
  std::size_t bytes() const;

  // The columns of step 1 (#V×#rows, split in real and imaginary parts so that adding one is two
  // plain loops) and of step 2 (#V×#rows).
  const Eigen::MatrixXd& similarity_real() const { return similarity_real_; }
  const Eigen::MatrixXd& similarity_imag() const { return similarity_imag_; }
  const Eigen::MatrixXd& rigid() const { return rigid_; }

  // A copy with the given columns only.
  Responses Select(const std::vector<Eigen::Index>& columns) const;

  // Appends the responses of `added`. Asks `cancel` between blocks of columns.
  Status Append(const RegisteredMeshParts& mesh, const std::vector<Row>& added,
                const CancelToken& cancel);

 private:
  Eigen::MatrixXd similarity_real_, similarity_imag_, rigid_;
};

}  // namespace arap
