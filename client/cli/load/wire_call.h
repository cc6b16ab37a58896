// WireCall: one StreamDeform call that waits for nothing: whoever owns it is told what comes.
#pragma once

#include <chrono>
#include <cstddef>

#include <grpcpp/grpcpp.h>

#include "arap/v1/deformation_service.grpc.pb.h"
#include "client/src/channel.h"
#include "core/base/mutex.h"

namespace arap::cli {

// Counts what is under way, so that nothing that it uses goes before it. Thread-safe.
class Gate {
 public:
  void Enter();
  // The last thing that is done: the gate may be gone afterwards.
  void Leave();
  // Until nothing is under way.
  void AwaitEmpty();
  // Until fewer are, but not beyond the time: false then.
  bool AwaitFewer(std::size_t fewer, std::chrono::steady_clock::time_point until);

 private:
  Mutex mutex_;
  CondVar changed_;
  std::size_t inside_ ABSL_GUARDED_BY(mutex_) = 0;
};

// Wakes who waits for something that others do. Thread-safe.
class Bell {
 public:
  void Ring();
  // Until it rings, has rung since it was last waited for, or the time has come.
  void AwaitUntil(std::chrono::steady_clock::time_point until);

 private:
  Mutex mutex_;
  CondVar changed_;
  bool rung_ ABSL_GUARDED_BY(mutex_) = false;
};

// Owns itself: it goes when the call is over and the owner was told. Messages are read as fast as the
// owner takes them; one is written at a time. Holds two messages and what gRPC keeps of a call, some
// 20 kB besides the shape.
class WireCall final
    : public grpc::ClientBidiReactor<v1::StreamDeformRequest, v1::StreamDeformResponse> {
 public:
  // Called on gRPC's threads. A message and the end of a write may be told at the same time; of each
  // there is one at a time.
  class Owner {
   public:
    virtual ~Owner() = default;
    virtual void OnMessage(const v1::StreamDeformResponse& response) = 0;
    // The message was taken by the transport; or it never will be, nor any other.
    virtual void OnWritten(bool ok) = 0;
    // Nothing more comes, and the call must not be used any more.
    virtual void OnReadEnd() = 0;
    // It is over, and how. The last of all.
    virtual void OnOver(const grpc::Status& status) = 0;
  };

  // Starts the call; `prepare` sets up its context.
  template <class Prepare>
  static WireCall* Start(client::internal::Channel& channel, Owner& owner, Gate& gate,
                         const Prepare& prepare) {
    auto* const call = new WireCall(owner, gate);
    prepare(call->context_);
    gate.Enter();
    channel.deformation().async()->StreamDeform(&call->context_, call);
    call->AddHold();
    call->StartRead(&call->incoming_);
    call->StartCall();
    return call;
  }

  ~WireCall() override = default;

  // The request to fill before Write.
  v1::StreamDeformRequest& outgoing() { return outgoing_; }
  // Not before the owner was told that the message before it is written.
  void Write() { StartWrite(&outgoing_); }
  void EndWriting() { StartWritesDone(); }
  void Cancel() { context_.TryCancel(); }

 private:
  WireCall(Owner& owner, Gate& gate) : owner_(owner), gate_(gate) {}
  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnDone(const grpc::Status& status) override;

  Owner& owner_;
  Gate& gate_;
  grpc::ClientContext context_;
  v1::StreamDeformRequest outgoing_;
  v1::StreamDeformResponse incoming_;
};

}  // namespace arap::cli
