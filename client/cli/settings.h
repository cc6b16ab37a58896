// What a command line leaves open and the environment or a file says: where the server is, who asks,
// how long to wait. A flag goes before the environment, and the environment before the file.
//
// Every setting has one name: --tls-ca is the flag, ARAPCTL_TLS_CA the variable, tls-ca the key.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include "arap/base/result.h"

namespace arap::cli {

struct Setting {
  std::string_view key;
  bool identity;  // who asks and how that travels: not for a private server
  std::string_view meaning;
};
// All of them, in the order in which they are documented.
std::span<const Setting> Settings();
// "ARAPCTL_TLS_CA" of "tls-ca".
std::string VariableOf(std::string_view key);

// The file: $ARAPCTL_CONFIG, else arapctl/config in $XDG_CONFIG_HOME, else ~/.config/arapctl/config.
// Empty when the environment says none of these.
std::string ConfigPath();

// The words, such as "--server=unix:/run/arapd.sock", that the environment and the file add to those of
// `command`. What `given` has already is left out, and with --spawn all of the identity and the server.
// An identity of the file is for the server of the file alone: who names another one by flag or variable
// sends it no token of this one. kInvalidOption with the path for a file that is not as it should be:
// a key that is unknown or twice, a section. kNotFound for an $ARAPCTL_CONFIG that cannot be read.
Result<std::vector<std::string>> SettingWords(const CLI::App& command,
                                              std::span<const std::string> given);

}  // namespace arap::cli
