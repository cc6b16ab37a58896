// Client: a connection to one arapd.
//
//   auto client = arap::client::Client::Connect("localhost:50051");
//   if (auto ready = client.WaitReady(std::chrono::seconds(5)); !ready) …
//   auto session = client.CreateSession();
//   auto mesh = session->RegisterMesh(planar_mesh, {});
//   auto set = session->CompileHandles("set", mesh->mesh.id, handles);
//   auto shape = session->Deform("set", targets, {});
//
// A Client is a value: copies share the connection. All members may be called from any thread at
// the same time. Calls block until the answer is there; error.h says what an error holds.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "arap/client/call_options.h"
#include "arap/client/connect_options.h"
#include "arap/client/error.h"
#include "arap/client/flatten.h"
#include "arap/client/mesh.h"
#include "arap/client/server_info.h"
#include "arap/client/session.h"

namespace arap::client {

namespace internal {
class Channel;
}

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
  // of its own; never fails by itself.
  static Client Connect(const std::string& address);
  // The same with TLS and an identity. kInvalidOption with the field for options that do not go
  // together, a file that cannot be read, or a token that would travel in plaintext; whether the
  // server accepts them is the calls' to say (kUnauthenticated; kDraining for a handshake).
  static Result<Client> Connect(const std::string& address, const ConnectOptions& options);

  // Waits until the connection stands. kDeadlineExceeded after `timeout`.
  Status WaitReady(std::chrono::milliseconds timeout) const;

  Result<ServerInfo> GetServerInfo(const CallOptions& call = {}) const;

  // Opens a session on the server. Repeating it with the same id and arguments is harmless.
  Result<Session> CreateSession(const SessionOptions& options = {},
                                const CallOptions& call = {}) const;
  // A session that exists already; asks nothing.
  Session AttachSession(std::string id) const;
  // The caller's sessions, `page_size` (1 to 1000; 0: the server's choice) at a time.
  Result<SessionPage> ListSessions(std::uint32_t page_size = 0, const std::string& page_token = {},
                                   const CallOptions& call = {}) const;

  // Flattens a surface, true to size. Stateless: needs no session.
  Result<FlatSurface> Flatten(const SurfaceMesh& mesh, const FlattenOptions& options = {},
                              const CallOptions& call = {}) const;

 private:
  explicit Client(std::shared_ptr<internal::Channel> channel);

  std::shared_ptr<internal::Channel> channel_;
};

}  // namespace arap::client
