#include "server/config/config.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <fstream>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <string_view>
#include <thread>
#include <utility>

#include <CLI/CLI.hpp>

#include "core/base/try.h"

namespace arap::config {
namespace {

constexpr const char* kPrefix = "ARAPD_";
constexpr const char* kConfigFlag = "--config";

std::string_view Find(const std::vector<std::string>& environment, const std::string& name) {
  for (const std::string_view entry : environment) {
    if (entry.starts_with(name + "=")) return entry.substr(name.size() + 1);
  }
  return {};
}

// Where sessions are kept unless told otherwise: the first that is there of $STATE_DIRECTORY (as
// systemd gives it), $XDG_STATE_HOME/arapd and $HOME/.local/state/arapd; else /var/lib/arapd.
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

// A parser with its own copy of what it fills.
struct Parser {
  Config config;
  CLI::App app{"As-rigid-as-possible deformation and flattening as a service.", "arapd"};

  explicit Parser(const std::vector<std::string>& environment) {
    config.host.store.store = "sqlite:" + StateDirectory(environment);
    const std::size_t cores = std::max(1u, std::thread::hardware_concurrency());
    config.host.lanes.workers = cores;
    config.host.lanes.job_workers = std::max<std::size_t>(1, cores / 2);
    config.host.admin = "127.0.0.1:0";
    AddFlags(app, config);
    app.set_config(kConfigFlag, "", "Read flags from this file, TOML or INI");
    app.allow_config_extras(CLI::config_extras_mode::error);
  }
};

std::string NameOf(const CLI::Option& option) { return option.get_lnames().front(); }

// --max-sessions → ARAPD_MAX_SESSIONS.
std::string VariableOf(const CLI::Option& option) {
  std::string variable = kPrefix;
  for (const char c : NameOf(option)) {
    variable += c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  return variable;
}

// What may stand in the environment: no help, no version, no --check-config.
bool IsSetting(const CLI::Option& option) {
  if (option.get_lnames().empty()) return false;
  return option.get_configurable() || NameOf(option) == "config";
}

std::map<std::string, std::string> OurVariables(const std::vector<std::string>& environment) {
  std::map<std::string, std::string> ours;
  for (const std::string& entry : environment) {
    const std::size_t equals = entry.find('=');
    if (entry.starts_with(kPrefix) && equals != std::string::npos) {
      ours.emplace(entry.substr(0, equals), entry.substr(equals + 1));
    }
  }
  return ours;
}

// "--listen=a", "--listen=b" for "a,b".
void AddArguments(const CLI::Option& option, const std::string& value,
                  std::vector<std::string>& arguments) {
  const std::string flag = "--" + NameOf(option) + "=";
  if (option.get_expected_max() <= 1) {
    arguments.push_back(flag + value);
    return;
  }
  std::istringstream parts(value);
  for (std::string part; std::getline(parts, part, ',');) arguments.push_back(flag + part);
}

// CLI11 takes the arguments from the back.
void Parse(CLI::App& app, std::vector<std::string> arguments) {
  std::reverse(arguments.begin(), arguments.end());
  app.parse(std::move(arguments));
}

std::string ValueOf(const CLI::Option& option) {
  if (option.count() == 0) {
    const std::string text = option.get_default_str();
    return text.empty() && option.get_expected_max() == 0 ? "false" : text;
  }
  std::string joined;
  for (const std::string& part : option.results()) joined += (joined.empty() ? "" : ",") + part;
  return joined;
}

Result<Outcome> Said(const CLI::App& app, const CLI::ParseError& error) {
  std::ostringstream out, err;
  if (app.exit(error, out, err) == 0) {
    Outcome outcome;
    outcome.done = true;
    outcome.text = out.str();
    return outcome;
  }
  return Fail(FaultKind::kInvalidOption, error.what());
}

Result<mode_t> ModeOf(const std::string& octal) {
  unsigned mode = 0;
  const char* end = octal.data() + octal.size();
  const auto [stop, error] = std::from_chars(octal.data(), end, mode, 8);
  if (error == std::errc() && stop == end && mode <= 0777) return mode;
  return Fail(Fault(FaultKind::kInvalidOption, "--socket-mode is an octal number such as 0660.")
                  .Field("socket-mode"));
}

// The first line of the file of a flag.
Result<std::string> ReadPassword(const char* flag, const std::string& path) {
  std::ifstream file(path);
  std::string password;
  if (std::getline(file, password) && !password.empty()) return password;
  return Fail(Fault(FaultKind::kInvalidOption,
                    std::string("--") + flag + ": " + path + " cannot be read or is empty.")
                  .Field(flag));
}

// As a URL may have it.
std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0) {
      escaped += c;
    } else {
      constexpr const char* kDigits = "0123456789ABCDEF";
      escaped += {'%', kDigits[byte / 16], kDigits[byte % 16]};
    }
  }
  return escaped;
}

// Puts the password of the file into "redis://host" and "redis://user@host", also where these name
// sentinels, a cluster or TLS.
Status AddPassword(const std::string& path, std::string& store) {
  if (path.empty()) return {};
  constexpr const char* kFlag = "redis-password-file";
  const auto bad = [](std::string message) {
    return Fail(Fault(FaultKind::kInvalidOption, std::move(message)).Field(kFlag));
  };
  TRY(const std::string password, ReadPassword(kFlag, path));
  const std::size_t scheme = store.find("://");
  if (!store.starts_with("redis") || scheme == std::string::npos) {
    return bad("--redis-password-file: --store is not redis://….");
  }
  const std::size_t begin = scheme + 3;
  const std::size_t end = std::min(store.find('/', begin), store.size());
  const std::size_t at = store.rfind('@', end);
  if (at == std::string::npos) {
    store.insert(begin, ":" + Escaped(password) + "@");
    return {};
  }
  if (store.find(':', begin) < at) {
    return bad("--redis-password-file: --store has a password too.");
  }
  store.insert(at, ":" + Escaped(password));
  return {};
}

}  // namespace

// Reading: the command line is parsed once to see which flags it has; what the environment says of
// the others is added to it, and the file fills in the rest. (By itself CLI11 lets the file win
// over the environment.)
Result<Outcome> Read(const std::vector<std::string>& arguments,
                     const std::vector<std::string>& environment) {
  const auto variables = OurVariables(environment);
  std::vector<std::string> complete = arguments;
  std::set<std::string> flags, from_environment, known;
  {
    Parser line(environment);
    // The file is for the second parse: here only what the command line says counts.
    line.app.set_config();
    line.app.add_option(kConfigFlag);
    try {
      Parse(line.app, arguments);
    } catch (const CLI::ParseError& error) {
      return Said(line.app, error);
    }
    for (const CLI::Option* option : line.app.get_options()) {
      if (!IsSetting(*option)) continue;
      known.insert(VariableOf(*option));
      if (option->count() > 0) {
        flags.insert(NameOf(*option));
      } else if (const auto found = variables.find(VariableOf(*option));
                 found != variables.end() && !found->second.empty()) {
        from_environment.insert(NameOf(*option));
        AddArguments(*option, found->second, complete);
      }
    }
  }
  Parser parser(environment);
  try {
    Parse(parser.app, complete);
  } catch (const CLI::ParseError& error) {
    return Said(parser.app, error);
  }
  Outcome outcome;
  for (const CLI::Option* option : parser.app.get_options()) {
    if (!IsSetting(*option)) continue;
    const std::string name = NameOf(*option);
    const char* source = option->count() > 0 ? "file" : "default";
    if (flags.count(name) > 0) source = "flag";
    if (from_environment.count(name) > 0) source = "environment";
    outcome.settings.push_back({name, Redacted(ValueOf(*option)), source});
  }
  for (const auto& [variable, value] : variables) {
    if (known.count(variable) == 0) outcome.unknown.push_back(variable);
  }
  Config& config = parser.config;
  config.host.stuck_after = Milliseconds(config.stuck_seconds);
  Limits& limits = config.host.limits;
  limits.default_ttl = std::min(limits.default_ttl, limits.max_ttl);
  config.host.keepalive = Milliseconds(config.keepalive_seconds);
  config.host.keepalive_timeout = Milliseconds(config.keepalive_timeout_seconds);
  if (config.no_admin) config.host.admin.clear();
  constexpr double kAgeOfCertificates = 3'600;
  const bool certificates = !config.host.credentials.tls.client_ca.empty();
  const double age = config.connection_age_seconds;
  config.host.connections.most_age =
      Milliseconds(age >= 0 ? age : (certificates ? kAgeOfCertificates : 0));
  TRY(config.host.socket_mode, ModeOf(config.socket_mode));
  CHECK_OK(AddPassword(config.redis_password_file, config.host.store.store));
  // By the names that other programs have for them.
  store::S3Flags& s3 = config.host.store.s3;
  s3.key_id = Find(environment, "AWS_ACCESS_KEY_ID");
  s3.secret = Find(environment, "AWS_SECRET_ACCESS_KEY");
  s3.session_token = Find(environment, "AWS_SESSION_TOKEN");
  if (!config.redis_sentinel_password_file.empty()) {
    TRY(config.host.store.redis.sentinel_password,
        ReadPassword("redis-sentinel-password-file", config.redis_sentinel_password_file));
  }
  outcome.config = config;
  return outcome;
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
