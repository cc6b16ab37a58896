// The reactor behind StreamDeform. See stream_deform.h for the rules that it keeps.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include <arap/v1/deformation_service.pb.h>
#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

#include "arap/base/result.h"
#include "server/access/caller.h"
#include "server/budget/token_bucket.h"
#include "server/engine.h"
#include "server/rpc/caller_of.h"
#include "server/rpc/convert_shape.h"
#include "server/rpc/rpc_log.h"
#include "server/rpc/stream_outbox.h"
#include "server/runtime/stopwatch.h"
#include "server/streams/live_set.h"
#include "server/streams/open_streams.h"
#include "server/streams/stream_pace.h"

namespace arap::rpc {

// Reactions, jobs and End may run in parallel: all state is behind one mutex, except what a running
// job owns (named so). Every entry changes the state and pumps; the pump starts whatever has become
// possible. Jobs and drains hold a shared pointer, so that nothing is deleted under them.
class StreamDeformReactor final
    : public grpc::ServerBidiReactor<v1::StreamDeformRequest, v1::StreamDeformResponse>,
      public app::OpenStream,
      public std::enable_shared_from_this<StreamDeformReactor> {
 public:
  StreamDeformReactor(app::Engine& engine, grpc::CallbackServerContext* context,
                      app::Caller caller);
  // `admitted`: what CallerOf says. `identity` is looked at before this returns.
  void Start(const Identity& identity, const Status& admitted);

  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;
  void End(Fault reason) override;
  void Sweep(runtime::Clock::Steady now) override;

 private:
  enum class Work { kNone, kOpen, kUpdate, kEdit };
  // An update that was taken and has not started.
  struct Accepted {
    std::uint64_t sequence = 0;
    runtime::Stopwatch waiting;
    std::vector<Complex> picks;
  };

  // The pump and its steps, with mutex_ held; each step answers whether it got anywhere.
  void Pump();
  bool Take();
  bool Read();
  bool Begin();
  bool Write();
  void FinishWhenOver();

  // Parts of Take: false leaves the message held.
  bool TakeMessage();
  void TakeOpen();
  bool TakeUpdate(const v1::HandleUpdate& update);
  bool TakeEdit(v1::HandleEdit& edit);
  // Whether rate and load allow an update now; takes the rate's token.
  Status Grant(runtime::Clock::Steady now);
  Status Admit(runtime::Clock::Steady now);
  Status Merge(const v1::HandleUpdate& update);

  // Bodies of the jobs, without mutex_.
  void RunFind();
  void RunOpen();
  void RunUpdate();
  void RunEdit();
  Status FindSession();
  Result<app::LiveSet> OpenSet();
  Status Fill(const Deformer& deformer, const ShapeQuality& quality, std::uint64_t sequence,
              std::uint64_t revision, const runtime::Stopwatch& working, double queue_micros,
              v1::Shape* shape) const;

  bool Post(runtime::WorkerPool& lane, void (StreamDeformReactor::*job)());
  // Answers an update or an edit with an error.
  void Refuse(std::uint64_t sequence, const Fault& fault);
  bool idle() const { return work_ == Work::kNone && !next_ && outbox_.empty(); }
  bool ending() const { return end_.has_value() || cancelled_ || finished_; }
  void EndLocked(Fault reason);

  app::Engine& engine_;
  grpc::CallbackServerContext* const context_;
  const app::Caller caller_;
  app::TokenWatch watch_;                      // from Start until OnDone
  std::shared_ptr<StreamDeformReactor> self_;  // until OnDone

  std::mutex mutex_;
  // All below is guarded by mutex_.
  v1::StreamDeformRequest incoming_;  // gRPC's while reading_, a message to take while held_
  bool reading_ = false;
  bool held_ = false;
  bool reads_done_ = false;
  runtime::Clock::Steady heard_;  // when the client last said something
  app::TokenBucket rate_;
  std::optional<app::StreamPace> pace_;  // since it was opened
  bool granted_ = false;                 // the held update has its token

  bool opened_ = false;
  bool latest_ = true;
  ShapeOptions options_;
  std::shared_ptr<app::Session> session_;
  std::uint64_t end_listener_ = 0;
  // While an update runs its deformer is the job's; while an edit runs all of it is.
  std::optional<app::LiveSet> live_;
  std::optional<Accepted> next_;
  std::uint64_t replaced_ = 0;

  Work work_ = Work::kNone;
  // The running job's own.
  runtime::Stopwatch job_waiting_;
  v1::OpenStream job_open_;
  Accepted job_update_;
  std::vector<Target> job_targets_;
  std::uint64_t job_replaced_ = 0;
  v1::HandleEdit job_edit_;

  StreamOutbox outbox_;
  v1::StreamDeformResponse outgoing_;  // gRPC's while writing_
  bool writing_ = false;

  std::optional<Fault> end_;
  bool cancelled_ = false;
  bool finished_ = false;

  RpcLog log_;
  Status end_status_;
  std::uint64_t shapes_ = 0;
  std::uint64_t errors_ = 0;
  std::uint64_t total_replaced_ = 0;
};

}  // namespace arap::rpc
