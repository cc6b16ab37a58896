// How a command reaches its server: the flags --server and --spawn, and who it says it is.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "arap/client/client.h"

namespace arap::cli {

struct ServerFlags {
  std::string server;
  bool spawn = false;
  client::ConnectOptions connect = {};  // but for the token, which is read when connecting
  std::string token_file = {};          // empty: the token is in the environment, if there is one
};

// The environment variable with the token. Tokens are never on the command line, where others see
// them.
inline constexpr const char* kTokenVariable = "ARAPCTL_TOKEN";

// The token that a file holds. kNotFound when it cannot be read; kInvalidOption when it holds none.
Result<std::string> ReadTokenFile(const std::string& path);

// Exactly one of --server and --spawn has to be given, if not by the environment or the config file
// (client/cli/settings.h); a private server wants no identity.
void AddServerFlags(CLI::App& command, ServerFlags& flags);

// A connection that stands; it ends, with the private server if there is one, when this goes. Open
// it before gRPC is used: for a private server it forks. For one thread.
class Connection {
 public:
  static Result<Connection> Open(const ServerFlags& flags);
  // Several: all private servers are started before any connection is made.
  static Result<std::vector<Connection>> OpenAll(const std::vector<ServerFlags>& flags);
  Connection(Connection&& other) noexcept;
  Connection& operator=(Connection&& other) noexcept;
  ~Connection();

  const client::Client& client() const { return client_; }
  // How it was reached, for further connections.
  const std::string& address() const { return address_; }
  const client::ConnectOptions& options() const { return options_; }

 private:
  class SpawnedServer;
  Connection(std::unique_ptr<SpawnedServer> spawned, std::string address,
             client::ConnectOptions options, client::Client client);

  std::unique_ptr<SpawnedServer> spawned_;  // before the client: it has to outlive it
  std::string address_;
  client::ConnectOptions options_;
  client::Client client_;
};

}  // namespace arap::cli
