// How a command reaches its server: the flags --server and --spawn.
#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "arap/client/client.h"
#include "client/cli/spawned_server.h"

namespace arap::cli {

struct ServerFlags {
  std::string server;
  bool spawn = false;
};

// Exactly one of the two has to be given.
void AddServerFlags(CLI::App& command, ServerFlags& flags);

// A connection that stands; it ends, with the spawned server if there is one, when this goes.
class Connection {
 public:
  static Result<Connection> Open(const ServerFlags& flags);

  const client::Client& client() const { return client_; }
  // For further connections.
  const std::string& address() const { return address_; }

 private:
  Connection(std::optional<SpawnedServer> spawned, std::string address, client::Client client);

  std::optional<SpawnedServer> spawned_;  // before the client: it has to outlive it
  std::string address_;
  client::Client client_;
};

// Connects and waits until the connection stands.
Result<client::Client> ConnectReady(const std::string& address);

}  // namespace arap::cli
