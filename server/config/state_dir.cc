#include "server/config/state_dir.h"

#include <filesystem>
#include <string_view>
#include <system_error>

namespace arap::config {
namespace {

std::string_view Find(const std::vector<std::string>& environment, const std::string& name) {
  for (const std::string_view entry : environment) {
    if (entry.starts_with(name + "=")) return entry.substr(name.size() + 1);
  }
  return {};
}

}  // namespace

std::string StateDirectory(const std::vector<std::string>& environment) {
  // Systemd may name several, with colons between them.
  const std::string_view given = Find(environment, "STATE_DIRECTORY");
  if (!given.empty()) return std::string(given.substr(0, given.find(':')));
  if (const auto state = Find(environment, "XDG_STATE_HOME"); !state.empty()) {
    return std::string(state) + "/arapd";
  }
  if (const auto home = Find(environment, "HOME"); !home.empty()) {
    return std::string(home) + "/.local/state/arapd";
  }
  return "/var/lib/arapd";
}

Status MakeParents(const std::string& store) {
  constexpr std::string_view kSqlite = "sqlite:";
  if (!store.starts_with(kSqlite)) return {};
  const auto parent = std::filesystem::path(store.substr(kSqlite.size())).parent_path();
  if (parent.empty()) return {};
  std::error_code error;
  std::filesystem::create_directories(parent, error);
  if (!error) return {};
  return Fail(FaultKind::kStoreUnavailable,
              "The folder " + parent.string() + " cannot be made: " + error.message() + ".");
}

}  // namespace arap::config
