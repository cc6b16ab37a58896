// Caller: who is asking. Sessions, quotas and caches belong to its owner.
#pragma once

#include <string>

#include "server/budget/limits.h"

namespace arap::app {

enum class Role {
  kUser,   // sees what its owner has
  kAdmin,  // also lists and ends the sessions of others
};

// The owner of whoever gives no identity, where none is asked for.
inline constexpr const char* kNobody = "anonymous";

struct Caller {
  std::string owner = kNobody;  // a name (names.h)
  Role role = Role::kUser;
  OwnerLimits limits;  // of this owner
};

}  // namespace arap::app
