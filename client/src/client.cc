#include "arap/client/client.h"

#include <cstdint>
#include <utility>

#include "client/src/answers.h"
#include "client/src/calls.h"
#include "client/src/channel.h"
#include "core/base/try.h"
#include "proto/convert/mesh.h"
#include "proto/convert/plain.h"

namespace arap::client {

using internal::Call;
using internal::FromWire;
using internal::kLookUp;
using internal::kWork;

using Stub = v1::DeformationService::Stub;

constexpr std::size_t kIdBytes = 16;

Client::Client(std::shared_ptr<internal::Channel> channel) : channel_(std::move(channel)) {}

Client Client::Connect(const std::string& address) {
  return Client(std::make_shared<internal::Channel>(address));
}

Result<Client> Client::Connect(const std::string& address, const ConnectOptions& options) {
  TRY(auto channel, internal::Channel::Open(address, options));
  return Client(std::move(channel));
}

Status Client::WaitReady(std::chrono::milliseconds timeout) const {
  const auto deadline = internal::DeadlineOf({.timeout = timeout}, timeout);
  using Time = std::chrono::system_clock::time_point;
  if (channel_->grpc().WaitForConnected(deadline.value_or(Time::max()))) return {};
  return Fail(FaultKind::kDeadlineExceeded, "No connection to the server in time.");
}

Result<ServerInfo> Client::GetServerInfo(const CallOptions& call) const {
  return Call(channel_->server().async(), &v1::ServerService::Stub::async::GetServerInfo,
              v1::GetServerInfoRequest(), kLookUp, call)
      .map([](const v1::GetServerInfoResponse& response) { return FromWire(response); });
}

Result<Session> Client::CreateSession(const SessionOptions& options,
                                      const CallOptions& call) const {
  // The id is all that keeps others out.
  const std::string id = options.id.empty() ? internal::RandomHex(kIdBytes) : options.id;
  v1::CreateSessionRequest request;
  request.set_session_id(id);
  if (options.ttl) convert::ToWire(*options.ttl, request.mutable_ttl());
  request.mutable_labels()->insert(options.labels.begin(), options.labels.end());
  TRY(const v1::CreateSessionResponse response,
      Call(channel_->deformation().async(), &Stub::async::CreateSession, request, kLookUp, call,
           id));
  CHECK_OK(FromWire(response.session(), id));
  return Session(channel_, id);
}

Session Client::AttachSession(std::string id) const { return Session(channel_, std::move(id)); }

Result<SessionPage> Client::ListSessions(std::uint32_t page_size, const std::string& page_token,
                                         const CallOptions& call) const {
  v1::ListSessionsRequest request;
  request.set_page_size(page_size);
  request.set_page_token(page_token);
  TRY(const v1::ListSessionsResponse response,
      Call(channel_->deformation().async(), &Stub::async::ListSessions, request, kLookUp, call));
  return FromWire(response, page_size, page_token);
}

Result<OutlineMesh> Client::MeshOutline(std::span<const Outline> outlines,
                                        const OutlineOptions& options,
                                        const CallOptions& call) const {
  v1::MeshOutlineRequest request;
  for (const Outline& outline : outlines) {
    convert::AppendPoints(outline, request.add_outlines()->mutable_points());
  }
  convert::ToWire(options, &request);
  TRY(const v1::MeshOutlineResponse response,
      Call(channel_->deformation().async(), &Stub::async::MeshOutline, request, kWork, call));
  return FromWire(response);
}

Result<FlatSurface> Client::Flatten(const SurfaceMesh& mesh, const FlattenQuery& query,
                                    const CallOptions& call) const {
  v1::FlattenRequest request;
  internal::ToWire(mesh, query, &request);
  request.set_max_response_bytes(internal::kMaxMessageBytes);
  TRY(const v1::FlattenResponse response,
      Call(channel_->flattening().async(), &v1::FlatteningService::Stub::async::Flatten, request,
           kWork, call));
  return FromWire(response, mesh, query);
}

}  // namespace arap::client
