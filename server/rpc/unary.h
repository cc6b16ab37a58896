// The methods of a service, and the unary call: who asks → the request → where it runs → the
// handler → the answer. A service names its methods with what they cost, and each unary call goes
// through RunUnary.
//
// For gRPC it is a stream of one message each way: so it is asked who is calling before a byte of
// the request is read, the request may be waited for as long as we like, and messages are taken
// apart and put together on our lanes.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include <grpcpp/impl/codegen/proto_utils.h>
#include <grpcpp/impl/codegen/server_callback_handlers.h>
#include <grpcpp/impl/rpc_service_method.h>
#include <grpcpp/impl/service_type.h>
#include <grpcpp/server_context.h>
#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "server/access/caller.h"
#include "server/budget/gate.h"
#include "server/engine.h"
#include "server/rpc/caller_of.h"

namespace arap::rpc {

// What a handler knows of the RPC beside its request.
struct Call {
  app::Caller caller;       // who is asking
  CancelToken cancel;       // the caller's cancellation and deadline
  double queue_micros = 0;  // how long the call waited for a worker
  // The session of the request, if it was looked up on the way to the lane.
  std::shared_ptr<app::Session> session;
};

// The session of that id; the one that was looked up already, or the caller's. Faults: those of
// SessionRegistry::Use.
Result<std::shared_ptr<app::Session>> SessionOf(app::Engine& engine, const Call& call,
                                                const std::string& session_id);

// Checks and converts, uses the engine, converts back. It blocks on nothing but its own work. On a
// fault the response is unused.
template <class Request, class Response>
using Handler = Status (*)(app::Engine&, const Request&, const Call&, Response*);

// What a call is expected to take of a worker, from the lengths of its request and from what is in
// memory.
struct Expected {
  bool cold = false;   // what it names was evicted and has to be computed again
  double seconds = 0;  // of one worker
};

// Never blocks. The session is the one that the request names, or null when it is not in memory.
template <class Request>
using Expectation = Expected (*)(app::Engine&, const app::Session*, const Request&);

// What a handler does decides where it runs. What is expected to take longer than kLongFrameSeconds
// is a job.
enum class Cost {
  kTrivial,  // says what is known, whatever is asked: at once, and the request is not read
  kStore,    // may wait for the store: control
  kLookUp,   // the same, and when what it looks up was evicted: jobs
  kFrame,    // computes a frame: interactive; when what it needs was evicted: jobs
  kHeavy,    // factors or back-substitutions: jobs
};

struct Method {
  const char* name = "";
  Cost cost = Cost::kTrivial;
  bool noisy = false;         // logged at debug only
  app::Gate* gate = nullptr;  // taken from the request's arrival to the end; null: none
  bool open_to_all = false;   // needs no identity
};

// What every service works with. Both outlive it.
struct Backend {
  app::Engine& engine;
  const Identity& identity;
};

// A request and its response without their types.
class UnaryJob {
 public:
  virtual ~UnaryJob() = default;
  // False for bytes that are no such request.
  virtual bool Parse(grpc::ByteBuffer* bytes) = 0;
  // Of the request, in memory.
  virtual std::size_t bytes() const = 0;
  // For the log.
  virtual std::string session_id() const = 0;
  // Nothing for what computes nothing. `session` is null when it is not in memory.
  virtual Expected Expect(const app::Session* session) const = 0;
  virtual Status Work(const Call& call) = 0;
  // Puts the response into bytes.
  virtual bool Answer(grpc::ByteBuffer* bytes) = 0;
};

using UnaryStream = grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>;

// In the trailing metadata of the answer to a call that went through the queue of jobs: how many
// calls of its owner were before it there, and how many milliseconds it waited.
inline constexpr const char* kQueuePlace = "x-arapd-queue-place";
inline constexpr const char* kQueueWait = "x-arapd-queue-wait-ms";

// Finishes the call with the status of its work. A caller who is refused sends no request, takes no
// gate and no lane and looks nothing up; a full lane answers kOverloaded and a shut gate
// kLimitExceeded, with what waits before it and for how long; a request that there is no memory for
// is kLimitExceeded, one that takes too long to arrive kDeadlineExceeded, and a call that its
// caller has given up before it started is not begun.
UnaryStream* RunUnary(const Backend& backend, const Method& method,
                      grpc::CallbackServerContext* context, std::unique_ptr<UnaryJob> job);

template <class Request, class Response>
class UnaryJobOf final : public UnaryJob {
 public:
  UnaryJobOf(app::Engine& engine, Handler<Request, Response> handler,
             Expectation<Request> expectation)
      : engine_(engine), handler_(handler), expectation_(expectation) {}

  bool Parse(grpc::ByteBuffer* bytes) override {
    return grpc::SerializationTraits<Request>::Deserialize(bytes, &request_).ok();
  }
  std::size_t bytes() const override { return request_.SpaceUsedLong(); }
  std::string session_id() const override {
    if constexpr (requires { request_.session_id(); }) return request_.session_id();
    return {};
  }
  Expected Expect(const app::Session* session) const override {
    return expectation_ != nullptr ? expectation_(engine_, session, request_) : Expected{};
  }
  Status Work(const Call& call) override { return handler_(engine_, request_, call, &response_); }
  bool Answer(grpc::ByteBuffer* bytes) override {
    bool own = false;
    return grpc::SerializationTraits<Response>::Serialize(response_, bytes, &own).ok();
  }

 private:
  app::Engine& engine_;
  const Handler<Request, Response> handler_;
  const Expectation<Request> expectation_;
  Request request_;
  Response response_;
};

// A gRPC service from a list of its methods.
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
