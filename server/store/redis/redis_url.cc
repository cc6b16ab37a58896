#include "server/store/redis/redis_url.h"

#include <charconv>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace arap::store {
namespace {

constexpr std::string_view kScheme = "redis://";

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

// HOST, HOST:PORT, [v6] or [v6]:PORT.
bool ParsePlace(std::string_view place, RedisUrl& url) {
  std::string_view port;
  if (place.starts_with('[')) {
    const std::size_t end = place.find(']');
    if (end == std::string_view::npos) return false;
    url.host = place.substr(1, end - 1);
    port = place.substr(end + 1);
  } else {
    const std::size_t colon = place.find(':');
    url.host = place.substr(0, colon);
    port = colon == std::string_view::npos ? std::string_view() : place.substr(colon);
  }
  if (url.host.empty()) return false;
  if (port.empty()) return true;
  return port.front() == ':' && ParseInt(port.substr(1), 1, 65535, url.port);
}

bool Parse(std::string_view text, RedisUrl& url) {
  if (!text.starts_with(kScheme)) return false;
  text.remove_prefix(kScheme.size());
  if (const std::size_t at = text.rfind('@'); at != std::string_view::npos) {
    const std::string_view user = text.substr(0, at);
    if (!user.starts_with(':') || !Unescape(user.substr(1), url.password)) return false;
    text.remove_prefix(at + 1);
  }
  if (const std::size_t slash = text.find('/'); slash != std::string_view::npos) {
    const std::string_view database = text.substr(slash + 1);
    if (!database.empty() && !ParseInt(database, 0, 1'000'000, url.database)) return false;
    text = text.substr(0, slash);
  }
  return ParsePlace(text, url);
}

}  // namespace

Result<RedisUrl> ParseRedisUrl(const std::string& url) {
  RedisUrl parsed;
  if (Parse(url, parsed)) return parsed;
  Fault fault = Fault(FaultKind::kInvalidOption,
                      fmt::format("{} is not of the form redis://[:PASSWORD@]HOST[:PORT][/DB].",
                                  WithoutPassword(url)))
                    .Field("store");
  return Fail(std::move(fault));
}

std::string WithoutPassword(const std::string& url) {
  const std::size_t at = url.rfind('@');
  if (at == std::string::npos) return url;
  const std::size_t start = url.starts_with(kScheme) ? kScheme.size() : 0;
  return url.substr(0, start) + ":***" + url.substr(at);
}

}  // namespace arap::store
