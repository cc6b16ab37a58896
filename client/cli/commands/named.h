// What the commands on things of a server have in common: which server, whose session, what is named.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "client/cli/commands/commands.h"
#include "client/cli/connect/connection.h"
#include "client/cli/reply.h"

namespace arap::cli {

struct NamedOptions {
  ServerFlags server;
  Timeout timeout;
  bool json = false;
  std::string name;  // "SESSION", or "SESSION/NAME"

  std::string session() const { return name.substr(0, name.find('/')); }
  // Empty without one.
  std::string part() const {
    const std::size_t slash = name.find('/');
    return slash == std::string::npos ? std::string() : name.substr(slash + 1);
  }
  client::CallOptions call() const { return {timeout.value()}; }
};

// The server and the timeout, and where `shape` is not empty the name: "SESSION", "SESSION/MESH" or
// "SESSION/[MESH]", whose second part may be left out.
void AddNamed(CLI::App& command, NamedOptions& options, const std::string& shape,
              const std::string& help);

}  // namespace arap::cli
