// Config: everything that arapd can be told, and where from.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

#include "arap/base/result.h"
#include "server/host/host.h"

namespace CLI {
class App;
}

namespace arap::config {

struct LogOptions {
  std::string level = "info";
  std::string file;  // empty: standard error
  std::size_t max_bytes = std::size_t{64} << 20u;
  std::size_t files = 5;     // rotated ones, beside the one that is written
  std::string access = "-";  // "-": into the log; "off"; else a file of its own
};

struct Config {
  host::HostOptions host;
  LogOptions log;
  std::string socket_mode = "0600";
  std::string redis_password_file;
  std::string redis_sentinel_password_file;
  double connection_age_seconds = -1;  // less than 0: not told
  double drain_delay_seconds = 0;
  double drain_seconds = 5;
  double stuck_seconds = 10;
  double keepalive_seconds = 60;
  double keepalive_timeout_seconds = 20;
  bool no_admin = false;
  bool check = false;  // --check-config
};

// A setting as it is in force.
struct Setting {
  std::string name;    // of the flag, without dashes
  std::string value;   // without secrets
  std::string source;  // "flag", "environment", "file" or "default"
};

// What the command line came to.
struct Outcome {
  Config config;
  std::vector<Setting> settings;     // in the order of --help
  std::vector<std::string> unknown;  // ARAPD_… variables that name no flag
  bool done = false;                 // --help, --version: `text` is all there is to say
  std::string text;
};

// Reads the command line, the environment ("ARAPD_MAX_SESSIONS=5" for --max-sessions; a list is
// separated by commas) and the file of --config (TOML or INI; the names of the flags). A flag wins
// over the environment, that over the file, that over the default. kInvalidOption with a message
// for the terminal.
Result<Outcome> Read(const std::vector<std::string>& arguments,
                     const std::vector<std::string>& environment);

// Adds every flag but --config. `config` outlives `app`; its values are the defaults.
void AddFlags(CLI::App& app, Config& config);

// Whatever can be found wrong without serving: addresses, files, folders, numbers that contradict
// each other. Nothing is created, bound or connected. Faults name the flag in `field`.
Status Check(const Config& config);

// kPermissionDenied when anybody on the machine may write into a folder where sessions are kept.
Status CheckFolders(const store::StoreOptions& store);

// The value without a password: of "redis://user:word@host:1" and of "redis://:word@host:1" the
// word becomes "***".
std::string Redacted(const std::string& value);

std::chrono::milliseconds Milliseconds(double seconds);

}  // namespace arap::config
