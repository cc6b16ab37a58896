#include "client/src/channel.h"

#include <chrono>

namespace arap::client::internal {
namespace {

// Room for the largest meshes and shapes that a server may be told to allow.
constexpr int kMaxMessageBytes = 256 << 20;

grpc::ChannelArguments Arguments() {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(kMaxMessageBytes);
  arguments.SetMaxSendMessageSize(kMaxMessageBytes);
  // Channels to one address share a connection unless each has its own pool.
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  return arguments;
}

}  // namespace

Channel::Channel(const std::string& address)
    : channel_(grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), Arguments())),
      deformation_(v1::DeformationService::NewStub(channel_)),
      flattening_(v1::FlatteningService::NewStub(channel_)),
      server_(v1::ServerService::NewStub(channel_)) {}

void Prepare(grpc::ClientContext& context, const CallOptions& call, const std::string& session_id) {
  if (call.timeout) context.set_deadline(std::chrono::system_clock::now() + *call.timeout);
  if (!session_id.empty()) context.AddMetadata("x-session-id", session_id);
}

}  // namespace arap::client::internal
