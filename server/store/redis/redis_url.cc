#include "server/store/redis/redis_url.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include <fmt/format.h>

namespace arap::store {
namespace {

using Kind = RedisUrl::Kind;

struct Scheme {
  std::string_view text;
  Kind kind;
  bool tls;
};

constexpr Scheme kSchemes[] = {
    {"redis://", Kind::kServer, false},
    {"rediss://", Kind::kServer, true},
    {"redis+sentinel://", Kind::kSentinels, false},
    {"rediss+sentinel://", Kind::kSentinels, true},
    {"redis+cluster://", Kind::kCluster, false},
    {"rediss+cluster://", Kind::kCluster, true},
};

constexpr int kServerPort = 6379;
constexpr int kSentinelPort = 26379;

bool ParseInt(std::string_view text, int low, int high, int& number) {
  const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
  return read.ec == std::errc{} && read.ptr == text.data() + text.size() && number >= low &&
         number <= high;
}

bool Unescape(std::string_view text, std::string& plain) {
  for (; !text.empty(); text.remove_prefix(1)) {
    if (text.front() != '%') {
      plain += text.front();
      continue;
    }
    unsigned byte = 0;
    if (text.size() < 3) return false;
    const auto read = std::from_chars(text.data() + 1, text.data() + 3, byte, 16);
    if (read.ec != std::errc{} || read.ptr != text.data() + 3) return false;
    plain += static_cast<char>(byte);
    text.remove_prefix(2);
  }
  return true;
}

// USER, USER:PASSWORD or :PASSWORD.
bool ParseUser(std::string_view text, RedisAccess& access) {
  const std::size_t colon = std::min(text.find(':'), text.size());
  if (!Unescape(text.substr(0, colon), access.user)) return false;
  if (colon == text.size()) return !access.user.empty();
  return Unescape(text.substr(colon + 1), access.password);
}

bool ParseDatabase(std::string_view text, int& database) {
  return text.empty() || ParseInt(text, 0, 1'000'000, database);
}

// What stands after the places.
bool ParsePath(std::string_view path, RedisUrl& url) {
  switch (url.kind) {
    case Kind::kServer:
      return ParseDatabase(path, url.access.database);
    // A cluster has this database alone.
    case Kind::kCluster:
      return path.empty() || path == "0";
    case Kind::kSentinels:
      break;
  }
  const std::size_t slash = std::min(path.find('/'), path.size());
  url.master = path.substr(0, slash);
  path.remove_prefix(std::min(slash + 1, path.size()));
  return !url.master.empty() && ParseDatabase(path, url.access.database);
}

bool ParsePlaces(std::string_view text, RedisUrl& url) {
  const int port = url.kind == Kind::kSentinels ? kSentinelPort : kServerPort;
  for (bool more = true; more;) {
    const std::size_t comma = text.find(',');
    auto place = ParsePlace(text.substr(0, comma), port);
    if (!place) return false;
    url.places.push_back(*std::move(place));
    more = comma != std::string_view::npos;
    text.remove_prefix(more ? comma + 1 : text.size());
  }
  return url.kind != Kind::kServer || url.places.size() == 1;
}

bool Parse(std::string_view text, RedisUrl& url) {
  const auto* scheme =
      std::find_if(std::begin(kSchemes), std::end(kSchemes),
                   [text](const Scheme& candidate) { return text.starts_with(candidate.text); });
  if (scheme == std::end(kSchemes)) return false;
  text.remove_prefix(scheme->text.size());
  url.kind = scheme->kind;
  if (scheme->tls) url.access.tls.emplace();
  if (const std::size_t at = text.rfind('@'); at != std::string_view::npos) {
    if (!ParseUser(text.substr(0, at), url.access)) return false;
    text.remove_prefix(at + 1);
  }
  const std::size_t slash = std::min(text.find('/'), text.size());
  const std::string_view path = text.substr(std::min(slash + 1, text.size()));
  return ParsePath(path, url) && ParsePlaces(text.substr(0, slash), url);
}

}  // namespace

std::optional<RedisPlace> ParsePlace(std::string_view text, int default_port) {
  RedisPlace place;
  place.port = default_port;
  std::string_view port;
  if (text.starts_with('[')) {
    const std::size_t end = text.find(']');
    if (end == std::string_view::npos) return std::nullopt;
    place.host = text.substr(1, end - 1);
    port = text.substr(end + 1);
  } else {
    const std::size_t colon = std::min(text.rfind(':'), text.size());
    place.host = text.substr(0, colon);
    port = text.substr(colon);
  }
  if (place.host.empty()) return std::nullopt;
  if (port.empty()) return place;
  if (port.front() != ':' || !ParseInt(port.substr(1), 1, 65535, place.port)) return std::nullopt;
  return place;
}

bool NamesRedis(std::string_view store) {
  return store.starts_with("redis:") || store.starts_with("rediss:") ||
         store.starts_with("redis+") || store.starts_with("rediss+");
}

Result<RedisUrl> ParseRedisUrl(const std::string& url) {
  RedisUrl parsed;
  if (Parse(url, parsed)) return parsed;
  return Fail(Fault(FaultKind::kInvalidOption,
                    fmt::format("{} is not of the form redis://[USER[:PASSWORD]@]HOST[:PORT][/DB], "
                                "redis+sentinel://HOST[:PORT],…/NAME[/DB] or "
                                "redis+cluster://HOST[:PORT],… (rediss with TLS).",
                                WithoutPassword(url)))
                  .Field("store"));
}

std::string WithoutPassword(const std::string& url) {
  const std::size_t at = url.rfind('@');
  if (at == std::string::npos) return url;
  const std::size_t scheme = url.find("://");
  const std::size_t start = scheme == std::string::npos || scheme > at ? 0 : scheme + 3;
  const std::size_t colon = url.find(':', start);
  return url.substr(0, colon < at ? colon + 1 : start) + "***" + url.substr(at);
}

}  // namespace arap::store
