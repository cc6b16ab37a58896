#include "client/cli/connect/connection.h"

#include <cstdlib>
#include <utility>

#include "core/base/try.h"
#include "core/files/text_file.h"

namespace arap::cli {
namespace {

// The token of the file, else of the environment, else none.
Result<std::string> ReadToken(const std::string& path) {
  if (path.empty()) {
    const char* const token = std::getenv(kTokenVariable);
    return std::string(token == nullptr ? "" : token);
  }
  TRY(std::string token, ReadTextFile(path));
  token.erase(token.find_last_not_of(" \t\r\n") + 1);
  if (token.empty()) return Fail(FaultKind::kInvalidOption, path + " holds no token.");
  return token;
}

Result<client::ConnectOptions> OptionsOf(const ServerFlags& flags) {
  client::ConnectOptions options = flags.connect;
  // A private server is on a socket that only we know.
  if (flags.spawn) return options;
  TRY(options.token, ReadToken(flags.token_file));
  return options;
}

// Connects and waits until the connection stands.
Result<client::Client> ConnectReady(const std::string& address,
                                    const client::ConnectOptions& options) {
  constexpr std::chrono::seconds kTimeout{5};
  TRY(client::Client client, client::Client::Connect(address, options));
  if (const Status ready = client.WaitReady(kTimeout); !ready) {
    Fault fault = ready.error();
    fault.message = "Cannot reach " + address + ": " + fault.message +
                    (options.wants_tls()
                         ? " (does it speak TLS, with a certificate that --tls-ca vouches for and "
                           "the name of its address?)"
                         : " (if it speaks TLS, give --tls or --tls-ca)");
    return Fail(std::move(fault));
  }
  return client;
}

}  // namespace

void AddServerFlags(CLI::App& command, ServerFlags& flags) {
  auto* group = command.add_option_group("Server", "which server to use");
  group->add_option("--server", flags.server, "a running server: host:port or unix:PATH");
  auto* const spawn =
      group->add_flag("--spawn", flags.spawn, "run a private arapd for the length of the command");
  group->require_option(1);

  auto* identity = command.add_option_group("Identity", "who is asking, and how it travels");
  client::ConnectOptions& connect = flags.connect;
  const auto option = [&](const char* name, std::string& value, const char* help) {
    identity->add_option(name, value, help)->excludes(spawn);
  };
  const auto flag = [&](const char* name, bool& value, const char* help) {
    identity->add_flag(name, value, help)->excludes(spawn);
  };
  option("--token-file", flags.token_file,
         "file with the bearer token; without it the variable ARAPCTL_TOKEN counts");
  flag("--token-in-plaintext", connect.token_in_plaintext,
       "send the token to another machine without TLS, for everyone on the way to read");
  flag("--tls", connect.tls, "speak TLS; the other --tls flags imply it");
  option("--tls-ca", connect.root_certificates,
         "PEM file of who vouches for the server (default: the system's authorities)");
  option("--tls-cert", connect.certificate, "PEM file of the client's own certificate");
  option("--tls-key", connect.key, "PEM file of its private key");
  option("--tls-server-name", connect.server_name,
         "the name in the server's certificate, unless it is that of the address");
}

Result<Connection> Connection::Open(const ServerFlags& flags) {
  TRY(client::ConnectOptions options, OptionsOf(flags));
  std::optional<SpawnedServer> spawned;
  std::string address = flags.server;
  if (flags.spawn) {
    TRY(spawned, SpawnedServer::Start());
    address = spawned->address();
  }
  TRY(client::Client client, ConnectReady(address, options));
  return Connection(std::move(spawned), std::move(address), std::move(options), std::move(client));
}

Connection::Connection(std::optional<SpawnedServer> spawned, std::string address,
                       client::ConnectOptions options, client::Client client)
    : spawned_(std::move(spawned)),
      address_(std::move(address)),
      options_(std::move(options)),
      client_(std::move(client)) {}

Result<client::Client> Connection::Another() const { return ConnectReady(address_, options_); }

}  // namespace arap::cli
