#include "client/cli/settings.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <map>
#include <optional>
#include <sstream>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "client/cli/report.h"
#include "client/cli/shell/completion.h"
#include "core/base/try.h"
#include "core/files/text_file.h"

namespace arap::cli {
namespace {

constexpr std::string_view kServer = "server";

constexpr Setting kSettings[] = {
    {kServer, false, "a running server: host:port or unix:PATH"},
    {"timeout", false, "seconds to wait for a server that sends nothing new"},
    {"token-file", true, "file with the bearer token"},
    {"as-user", true, "the user that the calls are for, with the token of a gateway"},
    {"token-in-plaintext", true, "true: send the token without TLS"},
    {"tls", true, "true: speak TLS"},
    {"tls-ca", true, "PEM file of who vouches for the server"},
    {"tls-cert", true, "PEM file of the client's own certificate"},
    {"tls-key", true, "PEM file of its private key"},
    {"tls-server-name", true, "the name in the server's certificate"},
};

// Nothing for a variable that is not there or empty.
std::optional<std::string> Variable(const std::string& name) {
  const char* const value = std::getenv(name.c_str());
  if (value == nullptr || *value == '\0') return std::nullopt;
  return value;
}

using Values = std::map<std::string, std::string, std::less<>>;

auto Wrong(const std::string& path, std::string_view what) {
  return Fail(FaultKind::kInvalidOption, fmt::format("{}: {}", path, what));
}

Result<Values> ParseConfig(const std::string& text, const std::string& path) {
  CLI::ConfigBase reader;
  // Values are single: commas, brackets and spaces are part of them.
  reader.arrayBounds('\1', '\2')->arrayDelimiter('\3')->parentSeparator('\4');
  std::istringstream stream(text);
  Values values;
  for (const CLI::ConfigItem& item : reader.from_config(stream)) {
    if (!item.parents.empty()) {
      return Wrong(path, fmt::format("section [{}]: there are no sections, only lines KEY = VALUE.",
                                     Printable(item.parents.front())));
    }
    const auto* const known =
        std::find_if(std::begin(kSettings), std::end(kSettings),
                     [&](const Setting& setting) { return setting.key == item.name; });
    if (known == std::end(kSettings)) {
      std::vector<std::string> names;
      for (const Setting& setting : kSettings) names.emplace_back(setting.key);
      return Wrong(path, fmt::format("unknown key '{}'{}", Printable(item.name),
                                     DidYouMean(item.name, names)));
    }
    if (item.inputs.size() != 1 || values.contains(item.name)) {
      return Wrong(path, fmt::format("key '{}' is there twice.", item.name));
    }
    if (item.inputs.front().empty()) {
      return Wrong(path, fmt::format("key '{}' has no value.", item.name));
    }
    values.emplace(item.name, item.inputs.front());
  }
  return values;
}

Result<Values> ReadConfig() {
  const std::string path = ConfigPath();
  std::error_code error;
  if (path.empty()) return Values();
  if (!Variable("ARAPCTL_CONFIG") && !std::filesystem::exists(path, error)) return Values();
  TRY(const std::string text, ReadTextFile(path));
  return ParseConfig(text, path);
}

bool IsGiven(std::span<const std::string> words, std::string_view key) {
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
    return word.starts_with("--") && std::string_view(word).substr(2, key.size()) == key &&
           (word.size() == key.size() + 2 || word[key.size() + 2] == '=');
  });
}

}  // namespace

std::span<const Setting> Settings() { return kSettings; }

std::string VariableOf(std::string_view key) {
  std::string name = "ARAPCTL_";
  for (const char c : key) {
    name += c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  return name;
}

std::string ConfigPath() {
  if (const auto named = Variable("ARAPCTL_CONFIG")) return *named;
  if (const auto folder = Variable("XDG_CONFIG_HOME")) return *folder + "/arapctl/config";
  if (const auto home = Variable("HOME")) return *home + "/.config/arapctl/config";
  return {};
}

Result<std::vector<std::string>> SettingWords(const CLI::App& command,
                                              std::span<const std::string> given) {
  std::vector<std::string> words;
  if (command.get_option_no_throw("--server") == nullptr) return words;
  TRY(const Values file, ReadConfig());
  const bool spawn = IsGiven(given, "spawn");
  // Which server that is, by the flag's last word of it or the variable; the file's when neither says.
  const auto own = file.find(kServer);
  std::optional<std::string> named = Variable(VariableOf(kServer));
  for (std::size_t i = 0; i < given.size(); ++i) {
    if (given[i] == "--server" && i + 1 < given.size()) named = given[i + 1];
    if (given[i].starts_with("--server=")) named = given[i].substr(sizeof("--server=") - 1);
  }
  const bool own_server = !named || own == file.end() || own->second == *named;
  for (const Setting& setting : kSettings) {
    const std::string flag = fmt::format("--{}", setting.key);
    if (IsGiven(given, setting.key) || command.get_option_no_throw(flag) == nullptr) continue;
    if (spawn && (setting.identity || setting.key == kServer)) continue;
    std::optional<std::string> value = Variable(VariableOf(setting.key));
    const auto stored = file.find(setting.key);
    if (!value && stored != file.end() && (own_server || !setting.identity)) value = stored->second;
    if (value) words.push_back(flag + "=" + *value);
  }
  return words;
}

}  // namespace arap::cli
