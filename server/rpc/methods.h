// Methods: a gRPC service from a list of its methods.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include <grpcpp/impl/codegen/server_callback_handlers.h>
#include <grpcpp/impl/rpc_service_method.h>
#include <grpcpp/impl/service_type.h>
#include <grpcpp/support/server_callback.h>

#include "server/rpc/unary.h"

namespace arap::rpc {

// Every method is a stream to gRPC, because only those hear of a call before its request is there.
class Methods final : public grpc::Service {
 public:
  using Context = grpc::CallbackServerContext;

  // `service` as in its proto file: "arap.v1.DeformationService".
  Methods(const Backend& backend, std::string service)
      : backend_(backend), service_(std::move(service)) {}

  const std::string& service() const { return service_; }

  // Without an `expectation` the call computes nothing to speak of.
  template <class Request, class Response>
  void Unary(const Method& method, Handler<Request, Response> handler,
             Expectation<Request> expectation = nullptr) {
    const auto run = [backend = backend_, method, handler, expectation](Context* context) {
      return RunUnary(
          backend, method, context,
          std::make_unique<UnaryJobOf<Request, Response>>(backend.engine, handler, expectation));
    };
    Stream<grpc::ByteBuffer, grpc::ByteBuffer>(method.name, run);
  }

  // `start` makes the reactor of a new call.
  template <class Request, class Response>
  void Stream(const std::string& method,
              std::function<grpc::ServerBidiReactor<Request, Response>*(Context*)> start) {
    using grpc::internal::CallbackBidiHandler;
    using grpc::internal::RpcMethod;
    using grpc::internal::RpcServiceMethod;
    // gRPC keeps pointers to the names.
    paths_.push_back("/" + service_ + "/" + method);
    AddMethod(new RpcServiceMethod(paths_.back().c_str(), RpcMethod::BIDI_STREAMING, nullptr));
    MarkMethodCallback(static_cast<int>(paths_.size()) - 1,
                       new CallbackBidiHandler<Request, Response>(std::move(start)));
  }

 private:
  const Backend backend_;
  const std::string service_;
  std::deque<std::string> paths_;
};

}  // namespace arap::rpc
