// HostileServer: a server that answers as a test wants, right or wrong, on every method.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include <grpcpp/grpcpp.h>

#include "arap/v1/deformation_service.grpc.pb.h"
#include "arap/v1/flattening_service.grpc.pb.h"
#include "arap/v1/server_service.grpc.pb.h"

namespace arap::cli {

class HostileServer {
 public:
  using Track = grpc::ServerWriter<v1::DeformTrackResponse>;
  using Stream = grpc::ServerReaderWriter<v1::StreamDeformResponse, v1::StreamDeformRequest>;

  // Called on the server's threads. What is empty is answered rightly: meshes and handles are
  // accepted, every shape is the rest shape.
  struct Script {
    std::function<grpc::Status(v1::GetServerInfoResponse&)> info = {};
    std::function<grpc::Status(v1::RegisterMeshResponse&)> mesh = {};
    std::function<grpc::Status(v1::DeformResponse&)> deform = {};
    std::function<grpc::Status(const v1::FlattenRequest&, v1::FlattenResponse&)> flatten = {};
    std::function<grpc::Status(const v1::DeformTrackRequest&, Track&)> track = {};
    std::function<grpc::Status(Stream&)> stream = {};
  };

  // Listens on a free port of 127.0.0.1.
  explicit HostileServer(Script script);
  ~HostileServer();

  std::string address() const;

  // The rest shape of the last mesh that was registered, as the answer to `sequence`.
  v1::Shape Shape(std::uint64_t sequence) const;
  // Keeps a call waiting until the server goes, half a minute at most.
  grpc::Status Silence() const;

 private:
  class Services;

  std::unique_ptr<Services> services_;
  std::unique_ptr<grpc::Server> server_;
  int port_ = 0;
};

}  // namespace arap::cli
