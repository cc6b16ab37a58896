// What can be found wrong with a config without serving.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "core/base/try.h"
#include "server/config/config.h"
#include "server/host/credentials.h"
#include "server/host/listen.h"
#include "server/runtime/clock.h"
#include "server/store/open_store.h"

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
  CHECK_OK(host::CheckAddress(address, host::kForCalls));
  if (path.empty()) return {};
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
Status CheckCredentials(const host::HostOptions& options) {
  CHECK_OK(host::Credentials::Open(options.credentials, options.listen, options.limits.owner,
                                   std::make_shared<runtime::SystemClock>()));
  return {};
}

Status CheckStoreFlags(const store::StoreOptions& options) {
  if (auto good = store::CheckStore(options); !good) {
    std::string flag = good.error().field;
    std::replace(flag.begin(), flag.end(), '_', '-');
    return Fail(Bad(flag.c_str(), fmt::format("--{}: {}", flag, good.error().message)));
  }
  constexpr std::string_view kSqlite = "sqlite:";
  if (!options.store.starts_with(kSqlite)) return {};
  return CheckWritable("store", options.store.substr(kSqlite.size()), true);
}

}  // namespace

Status CheckFolders(const store::StoreOptions& store) {
  constexpr std::string_view kSqlite = "sqlite:";
  const std::string folder =
      store.store.starts_with(kSqlite) ? store.store.substr(kSqlite.size()) : std::string();
  for (const auto& [flag, path] :
       {std::pair{"store", folder}, std::pair{"blob-dir", store.blob_dir}}) {
    std::error_code error;
    const auto mode = std::filesystem::status(path, error).permissions();
    if (path.empty() || error ||
        (mode & std::filesystem::perms::others_write) == std::filesystem::perms::none) {
      continue;
    }
    return Fail(Fault(FaultKind::kPermissionDenied,
                      fmt::format("--{}: anybody may write into {}; chmod o-w it.", flag, path))
                    .Field(flag));
  }
  return {};
}

Status Check(const Config& config) {
  if (config.host.listen.empty()) return Fail(Bad("listen", "--listen names no address."));
  for (const std::string& address : config.host.listen) {
    CHECK_OK(CheckListen(address));
  }
  if (!config.host.admin.empty()) {
    CHECK_OK(host::CheckAddress(config.host.admin, host::kForOperators));
  }
  CHECK_OK(CheckCredentials(config.host));
  CHECK_OK(CheckStoreFlags(config.host.store));
  CHECK_OK(CheckFolders(config.host.store));
  for (const auto& [flag, path] :
       {std::pair{"log-file", config.log.file}, std::pair{"access-log", config.log.access}}) {
    if (path.empty() || path == "-" || path == "off") continue;
    CHECK_OK(CheckWritable(flag, path));
  }
  if (!config.log.file.empty() && config.log.file == config.log.access) {
    return Fail(Bad("access-log", "--access-log and --log-file name the same file."));
  }
  return {};
}

}  // namespace arap::config
