#include "client/src/channel.h"

#include <chrono>
#include <utility>

#include "client/src/credentials.h"

namespace arap::client::internal {
namespace {

// Room for the largest meshes and shapes that a server may be told to allow.
constexpr int kMaxMessageBytes = 256 << 20;

grpc::ChannelArguments Arguments() {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(kMaxMessageBytes);
  arguments.SetMaxSendMessageSize(kMaxMessageBytes);
  // A server that is back is found soon: by default pauses grow to two minutes.
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 100);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 2'000);
  // Channels to one address share a connection unless each has its own pool.
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  return arguments;
}

}  // namespace

Channel::Channel(const std::string& address)
    : Channel([address] {
        return grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), Arguments());
      }) {}

Result<std::shared_ptr<Channel>> Channel::Open(const std::string& address,
                                               const ConnectOptions& options) {
  if (auto good = Check(address, options); !good) return Fail(std::move(good.error()));
  auto credentials = CredentialsOf(options);
  if (!credentials) return Fail(std::move(credentials.error()));
  grpc::ChannelArguments arguments = Arguments();
  if (!options.server_name.empty()) arguments.SetSslTargetNameOverride(options.server_name);
  return std::shared_ptr<Channel>(
      new Channel([address, credentials = *std::move(credentials), arguments, options] {
        return grpc::experimental::CreateCustomChannelWithInterceptors(
            address, credentials, arguments, TokenSender(options));
      }));
}

std::shared_ptr<Channel> Channel::Another() const {
  return std::shared_ptr<Channel>(new Channel(connect_));
}

Channel::Channel(Connect connect)
    : connect_(std::move(connect)),
      channel_(connect_()),
      deformation_(v1::DeformationService::NewStub(channel_)),
      flattening_(v1::FlatteningService::NewStub(channel_)),
      server_(v1::ServerService::NewStub(channel_)) {}

void Prepare(grpc::ClientContext& context, const CallOptions& call, const std::string& session_id) {
  if (call.timeout) context.set_deadline(std::chrono::system_clock::now() + *call.timeout);
  if (!session_id.empty()) context.AddMetadata("x-session-id", session_id);
}

}  // namespace arap::client::internal
