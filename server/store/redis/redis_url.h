// Where Redis is: one server, sentinels that know which server it is, or a cluster.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "arap/base/result.h"

namespace arap::store {

struct RedisPlace {
  std::string host;  // without the brackets of an IPv6 address
  int port = 0;

  bool operator==(const RedisPlace&) const = default;
};

// Files in PEM, read at every connection, so that new ones need no restart.
struct RedisTls {
  std::string ca;           // empty: the authorities of this machine
  std::string certificate;  // of this client, with its chain; empty: none
  std::string key;          // its private key
};

// Who is calling, and how.
struct RedisAccess {
  std::string user;      // empty: the default user
  std::string password;  // without a user, empty: nobody is named
  int database = 0;
  std::optional<RedisTls> tls;
};

// redis://[USER[:PASSWORD]@]HOST[:PORT][/DB]
// redis+sentinel://[USER[:PASSWORD]@]HOST[:PORT],…/NAME[/DB]
// redis+cluster://[USER[:PASSWORD]@]HOST[:PORT],…
// and with TLS rediss://, rediss+sentinel://, rediss+cluster://.
struct RedisUrl {
  enum class Kind { kServer, kSentinels, kCluster };

  Kind kind = Kind::kServer;
  // At least one: the server, some of the sentinels, some of the cluster's nodes.
  std::vector<RedisPlace> places;
  std::string master;  // what the sentinels call it
  RedisAccess access;
};

// Whether this is meant for ParseRedisUrl, well-formed or not.
bool NamesRedis(std::string_view store);

// %XX stands for a byte of user or password. kInvalidOption with the field "store"; the password is
// not in it.
Result<RedisUrl> ParseRedisUrl(const std::string& url);

// For showing: the password as ***.
std::string WithoutPassword(const std::string& url);

// HOST, HOST:PORT, [V6] or [V6]:PORT; an unbracketed V6:PORT as MOVED has it too. Nothing for
// anything else.
std::optional<RedisPlace> ParsePlace(std::string_view text, int default_port);

}  // namespace arap::store
