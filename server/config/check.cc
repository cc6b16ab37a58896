#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <sys/un.h>
#include <unistd.h>

#include "server/config/config.h"
#include "server/host/access.h"
#include "server/host/admin_http.h"
#include "server/host/listen.h"
#include "server/runtime/clock.h"
#include "server/store/redis/redis_url.h"

namespace arap::config {
namespace {

Fault Bad(const char* flag, std::string message) {
  return Fault(FaultKind::kInvalidOption, std::move(message)).Field(flag);
}

// A file that can be written, or made in a folder that can be.
Status CheckWritable(const char* flag, const std::string& path, bool folder_wanted = false) {
  const std::filesystem::path file(path);
  std::error_code error;
  if (!folder_wanted && std::filesystem::is_directory(file, error)) {
    return Fail(Bad(flag, fmt::format("--{}: {} is a folder.", flag, path)));
  }
  if (std::filesystem::exists(file, error)) {
    if (access(path.c_str(), W_OK) == 0) return {};
    return Fail(Bad(flag, fmt::format("--{}: {} cannot be written.", flag, path)));
  }
  std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  // The parents of a folder are made with it.
  while (folder_wanted && !std::filesystem::exists(folder, error)) {
    folder = folder.has_parent_path() ? folder.parent_path() : ".";
  }
  if (access(folder.c_str(), W_OK | X_OK) == 0) return {};
  return Fail(Bad(flag, fmt::format("--{}: the folder of {} does not exist or cannot be written.",
                                    flag, path)));
}

Status CheckListen(const std::string& address) {
  const std::string path = host::UnixPath(address);
  if (path.empty()) return host::PrepareAddress(address);  // looks at the text only
  if (path.size() >= sizeof(sockaddr_un{}.sun_path)) {
    return Fail(Bad(
        "listen", fmt::format("Cannot listen on {}: the path is too long for a socket.", address)));
  }
  const std::filesystem::path file(path);
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  std::error_code error;
  if (std::filesystem::exists(file, error) && !std::filesystem::is_socket(file, error)) {
    return Fail(
        Bad("listen", fmt::format("Cannot listen on {}: something else is there.", address)));
  }
  if (access(folder.c_str(), W_OK | X_OK) == 0) return {};
  return Fail(Bad("listen", fmt::format("Cannot listen on {}: its folder does not exist or cannot "
                                        "be written.",
                                        address)));
}

// Reads certificates and tokens, and lets them go.
Status CheckAccess(const host::HostOptions& options) {
  const auto opened = host::Access::Open(options.access, options.listen, options.limits.owner,
                                         std::make_shared<runtime::SystemClock>());
  if (!opened) return Fail(opened.error());
  return {};
}

Status CheckStore(const store::StoreOptions& options) {
  constexpr std::string_view kSqlite = "sqlite:", kRedis = "redis:";
  const std::string& spec = options.store;
  if (spec == "memory") return {};
  if (spec.starts_with(kRedis)) {
    if (auto url = store::ParseRedisUrl(spec); !url) return Fail(std::move(url.error()));
    if (!options.blob_dir.empty()) return {};
    return Fail(Bad("blob-dir", "With redis, --blob-dir is needed, a folder for the meshes."));
  }
  if (!spec.starts_with(kSqlite) || spec.size() == kSqlite.size()) {
    return Fail(Bad("store", "--store is memory, sqlite:DIR or redis://HOST:PORT."));
  }
  return CheckWritable("store", spec.substr(kSqlite.size()), true);
}

}  // namespace

Status Check(const Config& config) {
  if (config.host.listen.empty()) return Fail(Bad("listen", "--listen names no address."));
  for (const std::string& address : config.host.listen) {
    if (auto good = CheckListen(address); !good) return good;
  }
  if (!config.host.admin.empty()) {
    if (auto good = host::ParseAdminAddress(config.host.admin); !good) return Fail(good.error());
  }
  if (auto good = CheckAccess(config.host); !good) return good;
  if (auto good = CheckStore(config.host.store); !good) return good;
  for (const auto& [flag, path] :
       {std::pair{"log-file", config.log.file}, std::pair{"access-log", config.log.access}}) {
    if (path.empty() || path == "-" || path == "off") continue;
    if (auto good = CheckWritable(flag, path); !good) return good;
  }
  if (!config.log.file.empty() && config.log.file == config.log.access) {
    return Fail(Bad("access-log", "--access-log and --log-file name the same file."));
  }
  return {};
}

std::string Redacted(const std::string& value) {
  const std::size_t scheme = value.find("://");
  if (scheme == std::string::npos) return value;
  const std::size_t begin = scheme + 3;
  const std::size_t end = std::min(value.find_first_of("/?#,", begin), value.size());
  // The last @ before the path: a password may hold one.
  const std::size_t at = value.rfind('@', end);
  if (at == std::string::npos || at < begin || at >= end) {
    // A slash in a password would end the host too early.
    return value.find('@', begin) == std::string::npos ? value : value.substr(0, begin) + "***";
  }
  const std::size_t colon = value.find(':', begin);
  const std::size_t word = colon < at ? colon + 1 : begin;
  return value.substr(0, word) + "***" + value.substr(at);
}

std::chrono::milliseconds Milliseconds(double seconds) {
  return std::chrono::milliseconds(static_cast<std::int64_t>(seconds * 1e3));
}

}  // namespace arap::config
