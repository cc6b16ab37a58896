#include "arap/client/client.h"

#include <array>
#include <cstdint>
#include <random>
#include <span>
#include <utility>

#include "client/src/channel.h"
#include "client/src/convert.h"
#include "core/base/names.h"
#include "core/base/try.h"
#include "proto/convert/flatten.h"
#include "proto/convert/mesh.h"
#include "proto/convert/plain.h"

namespace arap::client {

using internal::Call;
using internal::FromWire;

namespace {

// 128 random bits in hexadecimal, from the system's generator: the id is all that keeps others out.
std::string NewSessionId() {
  std::random_device random;
  std::array<std::uint32_t, 4> bits;
  for (std::uint32_t& word : bits) word = random();
  const auto bytes = std::as_bytes(std::span(bits));
  return Hex({reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()});
}

}  // namespace

Client::Client(std::shared_ptr<internal::Channel> channel) : channel_(std::move(channel)) {}

Client Client::Connect(const std::string& address) {
  return Client(std::make_shared<internal::Channel>(address));
}

Result<Client> Client::Connect(const std::string& address, const ConnectOptions& options) {
  TRY(auto channel, internal::Channel::Open(address, options));
  return Client(std::move(channel));
}

Status Client::WaitReady(std::chrono::milliseconds timeout) const {
  if (channel_->grpc().WaitForConnected(std::chrono::system_clock::now() + timeout)) return {};
  return Fail(FaultKind::kDeadlineExceeded, "No connection to the server in time.");
}

Result<ServerInfo> Client::GetServerInfo(const CallOptions& call) const {
  return Call(channel_->server(), &v1::ServerService::Stub::GetServerInfo,
              v1::GetServerInfoRequest(), call)
      .map([](const v1::GetServerInfoResponse& response) { return FromWire(response); });
}

Result<Session> Client::CreateSession(const SessionOptions& options,
                                      const CallOptions& call) const {
  const std::string id = options.id.empty() ? NewSessionId() : options.id;
  v1::CreateSessionRequest request;
  request.set_session_id(id);
  if (options.ttl) convert::ToWire(*options.ttl, request.mutable_ttl());
  request.mutable_labels()->insert(options.labels.begin(), options.labels.end());
  return Call(channel_->deformation(), &v1::DeformationService::Stub::CreateSession, request, call,
              id)
      .map([&](const v1::CreateSessionResponse&) { return Session(channel_, id); });
}

Session Client::AttachSession(std::string id) const { return Session(channel_, std::move(id)); }

Result<SessionPage> Client::ListSessions(std::uint32_t page_size, const std::string& page_token,
                                         const CallOptions& call) const {
  v1::ListSessionsRequest request;
  request.set_page_size(page_size);
  request.set_page_token(page_token);
  return Call(channel_->deformation(), &v1::DeformationService::Stub::ListSessions, request, call)
      .map([](const v1::ListSessionsResponse& response) {
        SessionPage page;
        for (const v1::Session& session : response.sessions()) {
          page.sessions.push_back(FromWire(session));
        }
        page.next_page_token = response.next_page_token();
        return page;
      });
}

Result<FlatSurface> Client::Flatten(const SurfaceMesh& mesh, const FlattenQuery& query,
                                    const CallOptions& call) const {
  v1::FlattenRequest request;
  convert::ToWire(mesh, request.mutable_mesh());
  convert::ToWire(query.options, &request);
  request.set_surface_key(query.surface_key);
  request.set_include_first_step(query.first_step);
  request.set_include_singular_values(query.singular_values);
  request.set_float64(query.float64);
  TRY(const v1::FlattenResponse response,
      Call(channel_->flattening(), &v1::FlatteningService::Stub::Flatten, request, call));
  TRY(Flattening flat, convert::FromWire(response));
  return FlatSurface{std::move(flat), response.surface_cached(),
                     convert::Micros(response.queue_time()),
                     convert::Micros(response.solve_time())};
}

}  // namespace arap::client
