#include "arap/client/client.h"

#include <utility>

#include "client/src/channel.h"
#include "client/src/convert.h"
#include "client/src/session_id.h"

namespace arap::client {

using internal::Call;
using internal::FromWire;
using internal::ToWire;

Client::Client(std::shared_ptr<internal::Channel> channel) : channel_(std::move(channel)) {}

Client Client::Connect(const std::string& address) {
  return Client(std::make_shared<internal::Channel>(address));
}

Result<Client> Client::Connect(const std::string& address, const ConnectOptions& options) {
  auto channel = internal::Channel::Open(address, options);
  if (!channel) return Fail(std::move(channel.error()));
  return Client(*std::move(channel));
}

Status Client::WaitReady(std::chrono::milliseconds timeout) const {
  if (channel_->grpc().WaitForConnected(std::chrono::system_clock::now() + timeout)) return {};
  return Fail(FaultKind::kDeadlineExceeded, "no connection to the server in time");
}

Result<ServerInfo> Client::GetServerInfo(const CallOptions& call) const {
  return Call(channel_->server(), &v1::ServerService::Stub::GetServerInfo,
              v1::GetServerInfoRequest(), call)
      .map([](const v1::GetServerInfoResponse& response) { return FromWire(response); });
}

Result<Session> Client::CreateSession(const SessionOptions& options,
                                      const CallOptions& call) const {
  const std::string id = options.id.empty() ? internal::NewSessionId() : options.id;
  v1::CreateSessionRequest request;
  request.set_session_id(id);
  if (options.ttl) ToWire(*options.ttl, request.mutable_ttl());
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

Result<FlatSurface> Client::Flatten(const SurfaceMesh& mesh, const FlattenOptions& options,
                                    const CallOptions& call) const {
  v1::FlattenRequest request;
  ToWire(mesh, request.mutable_mesh());
  ToWire(options, &request);
  return Call(channel_->flattening(), &v1::FlatteningService::Stub::Flatten, request, call)
      .map([](const v1::FlattenResponse& response) { return FromWire(response); });
}

}  // namespace arap::client
