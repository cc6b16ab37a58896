// Flattening as a job for C.
#include <utility>

#include "client/c/objects.h"

using arap::Status;
using arap::c::CallOf;
using arap::c::Guard;
using arap::c::IdOf;
using arap::c::Need;
namespace client = arap::client;

// NOLINTBEGIN(readability-identifier-naming): the names of C.
struct arap_job {
  client::FlattenJob job;
};
// NOLINTEND(readability-identifier-naming)

namespace arap::c {
namespace {

std::int32_t StateOf(client::JobState state) {
  switch (state) {
    case client::JobState::kWaiting:
      return ARAP_JOB_WAITING;
    case client::JobState::kRunning:
      return ARAP_JOB_RUNNING;
    case client::JobState::kDone:
      return ARAP_JOB_DONE;
    case client::JobState::kFailed:
      return ARAP_JOB_FAILED;
    case client::JobState::kCancelled:
      break;
  }
  return ARAP_JOB_CANCELLED;
}

void Give(client::FlattenJob&& job, arap_job** out) {
  if (out != nullptr) *out = new arap_job{std::move(job)};
}

}  // namespace
}  // namespace arap::c

extern "C" {

const char* arap_job_id(const arap_job* job) { return job->job.id.c_str(); }
int32_t arap_job_state(const arap_job* job) { return arap::c::StateOf(job->job.state); }
const char* arap_job_phase(const arap_job* job) { return job->job.phase.c_str(); }
double arap_job_fraction(const arap_job* job) { return job->job.fraction; }
uint32_t arap_job_place(const arap_job* job) { return job->job.place; }
double arap_job_expected_seconds(const arap_job* job) { return job->job.expected_seconds; }
uint64_t arap_job_result_bytes(const arap_job* job) { return job->job.result_bytes; }
void arap_job_free(arap_job* job) { delete job; }

arap_error* arap_submit_flatten(const arap_session* session, const char* job_id,
                                const double* vertices, size_t vertex_count,
                                const uint32_t* triangles, size_t triangle_count,
                                const arap_flatten_options* options, const arap_call_options* call,
                                arap_job** out) {
  return Guard([&]() -> Status {
    CHECK_OK(Need(session, "session"));
    TRY(const auto id, IdOf(job_id, "job_id"));
    TRY(const auto work,
        arap::c::WorkOf(vertices, vertex_count, triangles, triangle_count, options));
    TRY(const auto calling, CallOf(call));
    TRY(auto job, session->session.SubmitFlatten(id, work.mesh, work.query, calling));
    arap::c::Give(std::move(job), out);
    return {};
  });
}

arap_error* arap_watch_job(const arap_session* session, const char* job_id,
                           arap_job_callback on_change, void* user, const arap_call_options* call,
                           arap_job** out) {
  return Guard([&]() -> Status {
    CHECK_OK(Need(session, "session"));
    TRY(const auto id, IdOf(job_id, "job_id"));
    TRY(const auto calling, CallOf(call));
    client::JobCallback tell;
    if (on_change != nullptr) {
      tell = [on_change, user](const client::FlattenJob& job) {
        const arap_job ours{job};
        return on_change(user, &ours) != 0;
      };
    }
    TRY(auto job, session->session.WatchJob(id, tell, calling));
    arap::c::Give(std::move(job), out);
    return {};
  });
}

arap_error* arap_job_result(const arap_session* session, const char* job_id, const double* vertices,
                            size_t vertex_count, const uint32_t* triangles, size_t triangle_count,
                            const arap_flatten_options* options, const arap_call_options* call,
                            arap_flat** out) {
  return Guard([&]() -> Status {
    CHECK_OK(Need(session, "session"));
    CHECK_OK(Need(out, "out"));
    TRY(const auto id, IdOf(job_id, "job_id"));
    TRY(const auto work,
        arap::c::WorkOf(vertices, vertex_count, triangles, triangle_count, options));
    TRY(const auto calling, CallOf(call));
    TRY(auto flat, session->session.GetResult(id, work.mesh, work.query, calling));
    *out = arap::c::FlatOf(std::move(flat));
    return {};
  });
}

arap_error* arap_cancel_job(const arap_session* session, const char* job_id,
                            const arap_call_options* call, arap_job** out) {
  return Guard([&]() -> Status {
    CHECK_OK(Need(session, "session"));
    TRY(const auto id, IdOf(job_id, "job_id"));
    TRY(const auto calling, CallOf(call));
    TRY(auto job, session->session.CancelJob(id, calling));
    arap::c::Give(std::move(job), out);
    return {};
  });
}

}  // extern "C"
