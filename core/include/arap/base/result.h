// Result<T>: a value or the Fault that kept us from it. Nothing in the core throws for bad input.
#pragma once

#include <string>
#include <utility>

#include <tl/expected.hpp>

#include "arap/base/fault.h"

namespace arap {

template <class T>
using Result = tl::expected<T, Fault>;
using Status = tl::expected<void, Fault>;

// return Fail(FaultKind::kEmptyMesh, "…");
inline tl::unexpected<Fault> Fail(FaultKind kind, std::string message) {
  return tl::unexpected<Fault>(Fault(kind, std::move(message)));
}
inline tl::unexpected<Fault> Fail(Fault fault) { return tl::unexpected<Fault>(std::move(fault)); }

}  // namespace arap
