// Caller: who is asking. Sessions, quotas and caches belong to its owner.
#pragma once

#include <string>

#include "arap/model/limits.h"
#include "core/base/names.h"

namespace arap::app {

enum class Role {
  kUser,   // sees what its owner has
  kAdmin,  // also lists and ends the sessions of others
};

using arap::kNobody;

struct Caller {
  std::string owner = kNobody;  // a name (core/base/names.h)
  Role role = Role::kUser;
  OwnerLimits limits;  // of this owner
};

}  // namespace arap::app
