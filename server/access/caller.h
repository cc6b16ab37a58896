// Caller: who is asking. Sessions, quotas and caches belong to its owner.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "arap/model/limits.h"
#include "core/base/names.h"

namespace arap::app {

enum class Role {
  kUser,     // sees what its owner has
  kAdmin,    // also lists and ends the sessions of others
  kGateway,  // speaks for users of its own, each an owner
};

using arap::kNobody;

// A service that was given the role. The owner of its user NAME is "GATEWAY/NAME". No token and no
// certificate can have such an owner, as a name has no slash.
struct Gateway {
  std::string owner;   // a name
  OwnerLimits limits;  // of the gateway and all its users together
};

struct Caller {
  std::string owner = kNobody;  // as IsOwner says
  Role role = Role::kUser;
  OwnerLimits limits;                   // of this owner
  std::optional<Gateway> gateway = {};  // that the owner belongs to
};

// Whether it is a name (core/base/names.h), or a gateway's and a user's with a slash in between.
inline bool IsOwner(std::string_view owner) {
  const auto slash = owner.find('/');
  if (slash == std::string_view::npos) return IsName(owner);
  return IsName(owner.substr(0, slash)) && IsName(owner.substr(slash + 1));
}

// Whether this owner is the gateway or one of its users.
inline bool BelongsTo(std::string_view owner, std::string_view gateway) {
  return owner.starts_with(gateway) &&
         (owner.size() == gateway.size() || owner[gateway.size()] == '/');
}

// What a gateway and its users have together, where `counts` has a number for each owner.
template <class Number>
Number SumOf(const std::map<std::string, Number>& counts, const std::string& gateway) {
  Number sum{};
  for (auto at = counts.lower_bound(gateway); at != counts.end() && at->first.starts_with(gateway);
       ++at) {
    if (BelongsTo(at->first, gateway)) sum += at->second;
  }
  return sum;
}

}  // namespace arap::app
