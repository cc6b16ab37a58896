// The jobs of a Session: each answer is checked as it comes, and one that comes in pieces is gone
// on with where it was lost.
#include <chrono>
#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <grpcpp/client_context.h>

#include "arap/client/session.h"
#include "client/src/answers.h"
#include "client/src/calls.h"
#include "client/src/channel.h"
#include "core/base/names.h"
#include "core/base/try.h"
#include "proto/convert/plain.h"

namespace arap::client {
namespace {

using internal::BadAnswer;
using internal::Call;
using internal::kLookUp;
using internal::kWork;
using Stub = v1::FlatteningService::Stub;

// What a result may weigh: more does not fit a message.
constexpr std::size_t kMostBytes = std::numeric_limits<int>::max();

// A request about a job.
template <class Request>
Request OfJob(const std::string& session_id, const std::string& job_id) {
  Request request;
  request.set_session_id(session_id);
  request.set_job_id(job_id);
  return request;
}

std::optional<JobState> StateOf(v1::JobState state) {
  switch (state) {
    case v1::JOB_STATE_WAITING:
      return JobState::kWaiting;
    case v1::JOB_STATE_RUNNING:
      return JobState::kRunning;
    case v1::JOB_STATE_DONE:
      return JobState::kDone;
    case v1::JOB_STATE_FAILED:
      return JobState::kFailed;
    case v1::JOB_STATE_CANCELLED:
      return JobState::kCancelled;
    default:
      return std::nullopt;
  }
}

// How the job of that name stands.
Result<FlattenJob> JobOf(const v1::Job& job, const std::string& job_id) {
  if (job.job_id() != job_id) {
    return Fail(BadAnswer(fmt::format("The server answered the job {}, not {}.",
                                      Quote(job.job_id()), Quote(job_id))));
  }
  const auto state = StateOf(job.state());
  if (!state) return Fail(BadAnswer("The server answered a job in no state that is known."));
  if (!(job.fraction() >= 0 && job.fraction() <= 1)) {
    return Fail(
        BadAnswer(fmt::format("The server answered that {} of a job is done.", job.fraction())));
  }
  FlattenJob made;
  made.id = job_id;
  made.state = *state;
  made.phase = job.phase();
  made.fraction = job.fraction();
  made.place = job.place();
  made.expected_seconds = 1e-6 * convert::Micros(job.expected_end());
  made.result_bytes = job.result_bytes();
  return made;
}

// Reads an answer in pieces to its end, from `request()` anew where a call was lost, until `take`
// fails. A piece that does not come within kQuickLimit is kDeadlineExceeded.
template <class Request, class Response, class Take>
Status ReadPieces(Stub& stub,
                  void (Stub::async::*method)(grpc::ClientContext*, const Request*,
                                              grpc::ClientReadReactor<Response>*),
                  const std::function<Request()>& request, const CallOptions& call,
                  const std::string& session_id, Take take) {
  constexpr internal::Method kPieces{internal::Repeat::kHarmless, kNoLimit};
  std::optional<Fault> bad;
  bool heard = false;
  const auto once = [&](const internal::Attempt& attempt) {
    const auto pieces = internal::PiecesCall<Response>::Make();
    attempt.Prepare(pieces->context());
    const std::stop_callback cancel(attempt.stop, [&] { pieces->Cancel(); });
    const Request asked = request();
    (stub.async()->*method)(&pieces->context(), &asked, pieces.get());
    pieces->Start();
    heard = false;
    Response response;
    while (pieces->Read(&response, std::chrono::steady_clock::now() + kQuickLimit)) {
      heard = true;
      if (Status taken = take(response); !taken) {
        bad = std::move(taken.error());
        return grpc::Status::OK;
      }
    }
    if (!pieces->is_late()) return pieces->status();
    const double seconds = std::chrono::duration<double>(kQuickLimit).count();
    return grpc::Status(grpc::StatusCode::DEADLINE_EXCEEDED,
                        fmt::format("The server has told nothing of the job for {:g} s.", seconds));
  };
  CHECK_OK(internal::MakeCall(kPieces, call, session_id, once, &heard));
  if (bad) return Fail(*std::move(bad));
  return {};
}

}  // namespace

Result<FlattenJob> Session::SubmitFlatten(const std::string& job_id, const SurfaceMesh& mesh,
                                          const FlattenQuery& query,
                                          const CallOptions& call) const {
  auto request = OfJob<v1::SubmitFlattenRequest>(id_, job_id);
  internal::ToWire(mesh, query, request.mutable_flatten());
  TRY(const v1::SubmitFlattenResponse response,
      Call(channel_->flattening().async(), &Stub::async::SubmitFlatten, request, kWork, call, id_));
  return JobOf(response.job(), job_id);
}

Result<FlattenJob> Session::WatchJob(const std::string& job_id, const JobCallback& on_change,
                                     const CallOptions& call) const {
  std::optional<FlattenJob> last;
  const auto take = [&](const v1::WatchJobResponse& response) -> Status {
    TRY(last, JobOf(response.job(), job_id));
    if (!on_change || on_change(*last)) return {};
    return Fail(FaultKind::kCancelled, "The caller stopped watching.");
  };
  const std::function request = [&] { return OfJob<v1::WatchJobRequest>(id_, job_id); };
  CHECK_OK(ReadPieces(channel_->flattening(), &Stub::async::WatchJob, request, call, id_, take));
  if (last && last->ended()) return *std::move(last);
  return Fail(BadAnswer("The server stopped telling of a job that has not ended."));
}

Result<FlatSurface> Session::GetResult(const std::string& job_id, const SurfaceMesh& mesh,
                                       const FlattenQuery& query, const CallOptions& call) const {
  std::string bytes;
  std::optional<std::size_t> total;
  const auto take = [&](const v1::DownloadResultResponse& piece) -> Status {
    const bool fits = piece.offset() == bytes.size() && piece.total_bytes() <= kMostBytes &&
                      total.value_or(piece.total_bytes()) == piece.total_bytes() &&
                      piece.data().size() <= piece.total_bytes() - bytes.size();
    if (!fits) return Fail(BadAnswer("The server answered a result whose pieces do not fit."));
    total = piece.total_bytes();
    bytes += piece.data();
    return {};
  };
  const std::function request = [&] {
    auto rest = OfJob<v1::DownloadResultRequest>(id_, job_id);
    rest.set_offset(bytes.size());
    return rest;
  };
  CHECK_OK(
      ReadPieces(channel_->flattening(), &Stub::async::DownloadResult, request, call, id_, take));
  if (total != bytes.size()) {
    return Fail(BadAnswer(fmt::format("The server answered {} bytes of a result of {}.",
                                      bytes.size(), total.value_or(0))));
  }
  v1::FlattenResponse response;
  if (!response.ParseFromString(bytes)) {
    return Fail(BadAnswer("The server answered a result that is none of a flattening."));
  }
  return internal::FromWire(response, mesh, query);
}

Result<FlattenJob> Session::CancelJob(const std::string& job_id, const CallOptions& call) const {
  const auto request = OfJob<v1::CancelJobRequest>(id_, job_id);
  TRY(const v1::CancelJobResponse response,
      Call(channel_->flattening().async(), &Stub::async::CancelJob, request, kLookUp, call, id_));
  TRY(auto job, JobOf(response.job(), job_id));
  if (!job.ended()) {
    return Fail(BadAnswer("The server answered that a job goes on which was cancelled."));
  }
  return job;
}

}  // namespace arap::client
