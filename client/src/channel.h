// The gRPC channel with the stubs on it, shared by everything that a Client hands out.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include <grpcpp/grpcpp.h>

#include "arap/client/client.h"
#include "arap/v1/deformation_service.grpc.pb.h"
#include "arap/v1/flattening_service.grpc.pb.h"
#include "arap/v1/server_service.grpc.pb.h"

namespace arap::client::internal {

// Room for the largest meshes and shapes that a server may be told to allow.
inline constexpr int kMaxMessageBytes = 256 << 20;

class Channel {
 public:
  // Plaintext, without a token.
  explicit Channel(const std::string& address);
  // kInvalidOption with the field: a file that cannot be read, a certificate without key or the
  // other way round, a token that is none or that would travel in plaintext to another machine.
  static Result<std::shared_ptr<Channel>> Open(const std::string& address,
                                               const ConnectOptions& options);

  // The same over a connection of its own: for when this one may be dead without saying so.
  std::shared_ptr<Channel> Another() const;

  grpc::Channel& grpc() const { return *channel_; }
  v1::DeformationService::Stub& deformation() const { return *deformation_; }
  v1::FlatteningService::Stub& flattening() const { return *flattening_; }
  v1::ServerService::Stub& server() const { return *server_; }

 private:
  using Connect = std::function<std::shared_ptr<grpc::Channel>()>;
  explicit Channel(Connect connect);

  Connect connect_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<v1::DeformationService::Stub> deformation_;
  std::unique_ptr<v1::FlatteningService::Stub> flattening_;
  std::unique_ptr<v1::ServerService::Stub> server_;
};

}  // namespace arap::client::internal
