#include "tests/cli/scripted_server.h"

#include <chrono>
#include <utility>

namespace arap::cli {

class ScriptedServer::Service final : public v1::DeformationService::Service {
 public:
  explicit Service(Script script) : script_(std::move(script)) {}

  grpc::Status StreamDeform(grpc::ServerContext* context, Stream* stream) override {
    return script_(*context, *stream);
  }

 private:
  const Script script_;
};

ScriptedServer::ScriptedServer(Script script)
    : service_(std::make_unique<Service>(std::move(script))) {
  grpc::ServerBuilder builder;
  builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port_);
  builder.RegisterService(service_.get());
  server_ = builder.BuildAndStart();
}

// Streams that are still open are cancelled at once.
ScriptedServer::~ScriptedServer() {
  if (server_) server_->Shutdown(std::chrono::system_clock::now());
}

std::string ScriptedServer::address() const { return "127.0.0.1:" + std::to_string(port_); }

void ScriptedServer::Open(Stream& stream) {
  Response response;
  v1::HandleSetInfo& set = *response.mutable_opened()->mutable_handle_set();
  set.set_handle_set_id("h");
  set.set_mesh_id("m");
  set.set_revision(1);
  stream.Write(response);
}

void ScriptedServer::Pong(Stream& stream, const Request& request) {
  Response response;
  response.mutable_pong()->set_nonce(request.ping().nonce());
  stream.Write(response);
}

namespace {

std::uint64_t SequenceOf(const ScriptedServer::Request& request) {
  return request.has_edit() ? request.edit().sequence() : request.update().sequence();
}

}  // namespace

void ScriptedServer::Shape(Stream& stream, const Request& request) {
  Response response;
  response.mutable_shape()->set_sequence(SequenceOf(request));
  response.mutable_shape()->mutable_positions()->Resize(6, 0);
  stream.Write(response);
}

void ScriptedServer::Error(Stream& stream, const Request& request, grpc::StatusCode code) {
  Response response;
  response.mutable_error()->set_sequence(SequenceOf(request));
  response.mutable_error()->mutable_status()->set_code(code);
  stream.Write(response);
}

void ScriptedServer::Serve(Stream& stream) {
  for (Request request; stream.Read(&request);) {
    if (request.has_open()) {
      Open(stream);
    } else if (request.has_ping()) {
      Pong(stream, request);
    } else {
      Shape(stream, request);
    }
  }
}

void ScriptedServer::Ignore(Stream& stream) {
  for (Request request; stream.Read(&request);) {
  }
}

}  // namespace arap::cli
