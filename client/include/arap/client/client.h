// Client: a connection to one arapd.
//
//   auto client = arap::client::Client::Connect("localhost:50051");
//   if (auto ready = client.WaitReady(std::chrono::seconds(5)); !ready) …
//   auto session = client.CreateSession();
//   auto registration = session->RegisterMesh(planar_mesh, {});
//   auto compilation = session->CompileHandles("set", registration->mesh.id, handles);
//   auto shape = session->Deform("set", targets);
//
// A Client is a value: copies share the connection. All members may be called from any thread at
// the same time. Calls block until the answer is there or their time is over; call.h says for how
// long, what is made again, and what an error holds.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "arap/client/call.h"
#include "arap/client/flatten.h"
#include "arap/client/mesh.h"
#include "arap/client/session.h"
#include "arap/model/limits.h"

namespace arap::client {

namespace internal {
class Channel;
}

// How a Client connects and who it says it is. Files are in PEM and read once, when connecting.
// Nothing of this is ever in a message or a log.
struct ConnectOptions {
  // Bearer token, sent with every call; empty: none. `arapctl token add` makes them.
  std::string token;
  // Without TLS a token is sent to this machine only (loopback, unix sockets), unless this allows
  // everybody on the way to read it.
  bool token_in_plaintext = false;
  // The user for whom all calls are made, where the token has the role gateway: a name, which the
  // server takes for the owner "GATEWAY/NAME". Empty: nobody but the gateway itself.
  std::string user;

  bool tls = false;               // implied by each of the files
  std::string root_certificates;  // who vouches for the server; empty: the system's authorities
  std::string certificate;        // the client's own, with its key, for servers that want one
  std::string key;
  std::string server_name;  // what the server's certificate says, unless that is in the address

  bool wants_tls() const {
    return tls || !root_certificates.empty() || !certificate.empty() || !key.empty();
  }
};

using arap::Limits;

// What the server is and what it allows.
struct ServerInfo {
  std::string version;  // semantic version
  Limits limits;        // in force; a request beyond one fails with a fault that names it
  std::vector<std::string> capabilities;  // names such as "basis.edge"
  std::uint32_t workers = 0;              // worker threads
};

struct SessionOptions {
  std::string id;  // empty: the library draws 128 random bits in hexadecimal
  std::optional<std::chrono::milliseconds> ttl;  // life without use, 1 s to max_ttl; default 1 h
  std::map<std::string, std::string> labels;     // at most 16
};

struct SessionPage {
  std::vector<SessionInfo> sessions;  // by id
  std::string next_page_token;        // empty at the end
};

class Client {
 public:
  // `address` is host:port or unix:PATH. Connects in the background, plain text, with a connection
  // of its own; never fails by itself. Other machines are reached through the proxy that the
  // environment names (grpc_proxy, https_proxy, http_proxy; no_proxy), this one never.
  static Client Connect(const std::string& address);
  // The same with TLS and an identity. kInvalidOption with the field for options that do not go
  // together, a file that cannot be read, or a token that would travel in plaintext; whether the
  // server accepts them is the calls' to say (kUnauthenticated; kDraining for a handshake).
  static Result<Client> Connect(const std::string& address, const ConnectOptions& options);

  // Waits until the connection stands. kDeadlineExceeded after `timeout`.
  Status WaitReady(std::chrono::milliseconds timeout) const;

  // Within kQuickLimit, as the other calls here but MeshOutline and Flatten.
  Result<ServerInfo> GetServerInfo(const CallOptions& call = {}) const;

  // Opens a session on the server. Repeating it with the same id and arguments is harmless.
  Result<Session> CreateSession(const SessionOptions& options = {},
                                const CallOptions& call = {}) const;
  // A session that exists already; asks nothing.
  Session AttachSession(std::string id) const;
  // The caller's sessions, `page_size` (1 to 1000; 0: the server's choice) at a time.
  Result<SessionPage> ListSessions(std::uint32_t page_size = 0, const std::string& page_token = {},
                                   const CallOptions& call = {}) const;

  // Triangles inside outlines, which may be simplified or grow before: a mesh to register.
  // Stateless: needs no session. Within kWorkLimit.
  Result<OutlineMesh> MeshOutline(std::span<const Outline> outlines,
                                  const OutlineOptions& options = {},
                                  const CallOptions& call = {}) const;

  // Flattens a surface, true to size. Stateless: needs no session. Within kWorkLimit.
  Result<FlatSurface> Flatten(const SurfaceMesh& mesh, const FlattenQuery& query = {},
                              const CallOptions& call = {}) const;

 private:
  explicit Client(std::shared_ptr<internal::Channel> channel);

  std::shared_ptr<internal::Channel> channel_;
};

}  // namespace arap::client
