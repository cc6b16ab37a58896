// RedisUrl: redis://[:PASSWORD@]HOST[:PORT][/DB].
#pragma once

#include <string>

#include "arap/base/result.h"

namespace arap::store {

struct RedisUrl {
  std::string host;  // without the brackets of an IPv6 address
  int port = 6379;
  std::string password;  // empty: none
  int database = 0;
};

// %XX stands for a byte of the password. kInvalidOption with the field "store"; the password is
// not in it.
Result<RedisUrl> ParseRedisUrl(const std::string& url);

// For showing: the password as ***.
std::string WithoutPassword(const std::string& url);

}  // namespace arap::store
