#include "client/cli/connection.h"

#include <utility>

namespace arap::cli {

void AddServerFlags(CLI::App& command, ServerFlags& flags) {
  auto* group = command.add_option_group("Server", "which server to use");
  group->add_option("--server", flags.server, "a running server: host:port or unix:PATH");
  group->add_flag("--spawn", flags.spawn, "run a private arapd for the length of the command");
  group->require_option(1);
}

Result<client::Client> ConnectReady(const std::string& address) {
  constexpr std::chrono::seconds kTimeout{5};
  client::Client client = client::Client::Connect(address);
  if (const Status ready = client.WaitReady(kTimeout); !ready) {
    Fault fault = ready.error();
    fault.message = "cannot reach " + address + ": " + fault.message;
    return Fail(std::move(fault));
  }
  return client;
}

Result<Connection> Connection::Open(const ServerFlags& flags) {
  std::optional<SpawnedServer> spawned;
  std::string address = flags.server;
  if (flags.spawn) {
    Result<SpawnedServer> started = SpawnedServer::Start();
    if (!started) return Fail(started.error());
    spawned = std::move(*started);
    address = spawned->address();
  }
  Result<client::Client> client = ConnectReady(address);
  if (!client) return Fail(client.error());
  return Connection(std::move(spawned), std::move(address), *std::move(client));
}

Connection::Connection(std::optional<SpawnedServer> spawned, std::string address,
                       client::Client client)
    : spawned_(std::move(spawned)), address_(std::move(address)), client_(std::move(client)) {}

}  // namespace arap::cli
