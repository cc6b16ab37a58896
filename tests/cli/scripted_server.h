// ScriptedServer: a server that says on streams what a test wants.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include <grpcpp/grpcpp.h>

#include "arap/v1/deformation_service.grpc.pb.h"

namespace arap::cli {

class ScriptedServer {
 public:
  using Request = v1::StreamDeformRequest;
  using Response = v1::StreamDeformResponse;
  using Stream = grpc::ServerReaderWriter<Response, Request>;
  // Runs for each stream, on a thread of its own.
  using Script = std::function<grpc::Status(grpc::ServerContext& context, Stream& stream)>;

  // Listens on a free port of 127.0.0.1.
  explicit ScriptedServer(Script script);
  ~ScriptedServer();

  std::string address() const;

  // Pieces of scripts. The first says that the stream is open, on the handle set "h"; the others
  // answer `request`, with three vertices.
  static void Open(Stream& stream);
  static void Pong(Stream& stream, const Request& request);
  static void Shape(Stream& stream, const Request& request);
  static void Error(Stream& stream, const Request& request, grpc::StatusCode code);
  // Answers everything, to the end.
  static void Serve(Stream& stream);
  // Reads, to the end, and says nothing.
  static void Ignore(Stream& stream);

 private:
  class Service;

  std::unique_ptr<Service> service_;
  std::unique_ptr<grpc::Server> server_;
  int port_ = 0;
};

}  // namespace arap::cli
