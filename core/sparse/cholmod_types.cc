#include "core/sparse/cholmod_types.h"

#include <fmt/format.h>

namespace arap {

Fault CholmodFault(int status, const char* what, std::size_t unknowns) {
  FaultKind kind = FaultKind::kNumerical;
  const char* text = "the factorisation failed";
  switch (status) {
    case CHOLMOD_NOT_POSDEF:
      text = "the matrix is not positive definite";
      break;
    case CHOLMOD_DSMALL:
      text = "the matrix is nearly singular";
      break;
    case CHOLMOD_OUT_OF_MEMORY:
      kind = FaultKind::kOutOfMemory;
      text = "out of memory";
      break;
    case CHOLMOD_TOO_LARGE:
      kind = FaultKind::kMeshTooLarge;
      text = "the problem is too large";
      break;
    default:
      break;
  }
  return Fault(kind, fmt::format("{} {} unknowns: {}.", what, unknowns, text));
}

}  // namespace arap
