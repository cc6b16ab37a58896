// LoadStub: a server that opens sessions and streams for a load generator, and does on streams what a
// test wants. Its shapes are the rest shape.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include <grpcpp/grpcpp.h>

#include "arap/v1/deformation_service.grpc.pb.h"

namespace arap::cli {

class LoadStub {
 public:
  using Request = v1::StreamDeformRequest;
  using Response = v1::StreamDeformResponse;
  using Stream = grpc::ServerReaderWriter<Response, Request>;
  // Runs for each stream, on a thread of its own, when it is open; it is the `number`-th.
  using Script = std::function<grpc::Status(LoadStub& stub, Stream& stream, std::size_t number)>;

  // What becomes of an opening of a session, by the `authorization` of the call.
  using Admit = std::function<grpc::Status(const std::string& authorization)>;

  // Listens on a free port of 127.0.0.1.
  explicit LoadStub(Script script, Admit admit = {});
  ~LoadStub();

  std::string address() const;
  std::size_t sessions() const { return sessions_; }
  std::size_t streams() const { return streams_; }

  // Pieces of scripts. Answers an update, an edit or a ping; or everything, to the end.
  void Answer(Stream& stream, const Request& request) const;
  grpc::Status Serve(Stream& stream) const;

 private:
  class Service;

  const Script script_;
  const Admit admit_;
  std::atomic<std::size_t> sessions_ = 0, streams_ = 0;
  mutable std::mutex mutex_;
  int vertices_ = 0;  // of the mesh
  std::unique_ptr<Service> service_;
  std::unique_ptr<grpc::Server> server_;
  int port_ = 0;
};

}  // namespace arap::cli
