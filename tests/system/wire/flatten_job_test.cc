// Flattening as a job over the wire: begun, watched, fetched, cancelled.
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "arap/client/client.h"
#include "tests/support/surfaces.h"
#include "tests/system/wire/flatten_fixture.h"

namespace arap::wire {
namespace {

class FlattenJobTest : public FlattenTest {
 protected:
  FlattenJobTest() {
    options().limits.max_message_bytes = std::size_t{64} << 20u;
    EXPECT_TRUE(CreateSession("s").ok());
  }

  grpc::Status Submit(const std::string& job, const v1::FlattenRequest& request,
                      v1::Job* begun = nullptr) {
    grpc::ClientContext context;
    SetDeadline(context);
    v1::SubmitFlattenRequest submit;
    submit.set_session_id("s");
    submit.set_job_id(job);
    *submit.mutable_flatten() = request;
    v1::SubmitFlattenResponse response;
    const grpc::Status status = flattening().SubmitFlatten(&context, submit, &response);
    if (begun != nullptr) *begun = response.job();
    return status;
  }

  // Everything that is told until the end.
  grpc::Status Watch(const std::string& job, std::vector<v1::Job>& told) {
    grpc::ClientContext context;
    SetDeadline(context);
    v1::WatchJobRequest request;
    request.set_session_id("s");
    request.set_job_id(job);
    const auto reader = flattening().WatchJob(&context, request);
    v1::WatchJobResponse response;
    while (reader->Read(&response)) told.push_back(response.job());
    return reader->Finish();
  }

  // Submits and waits for the end.
  v1::Job Done(const std::string& job, const v1::FlattenRequest& request) {
    EXPECT_TRUE(Submit(job, request).ok());
    std::vector<v1::Job> told;
    const grpc::Status status = Watch(job, told);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return told.empty() ? v1::Job() : told.back();
  }

  grpc::Status Get(const std::string& job, v1::FlattenResponse* flat, std::uint64_t most = 0) {
    grpc::ClientContext context;
    SetDeadline(context);
    v1::GetResultRequest request;
    request.set_session_id("s");
    request.set_job_id(job);
    request.set_max_response_bytes(most);
    v1::GetResultResponse response;
    const grpc::Status status = flattening().GetResult(&context, request, &response);
    *flat = response.flatten();
    return status;
  }

  // The bytes from `offset` on; nothing when the pieces do not fit together.
  std::optional<std::string> Download(const std::string& job, std::uint64_t offset = 0) {
    grpc::ClientContext context;
    SetDeadline(context);
    v1::DownloadResultRequest request;
    request.set_session_id("s");
    request.set_job_id(job);
    request.set_offset(offset);
    const auto reader = flattening().DownloadResult(&context, request);
    v1::DownloadResultResponse piece;
    std::string bytes;
    bool good = true;
    std::uint64_t total = 0;
    while (reader->Read(&piece)) {
      good = good && piece.offset() == offset + bytes.size() && piece.data().size() <= 256u << 10u;
      bytes += piece.data();
      total = piece.total_bytes();
    }
    if (!reader->Finish().ok() || !good || offset + bytes.size() != total) return std::nullopt;
    return bytes;
  }

  grpc::Status Cancel(const std::string& job, v1::Job* after) {
    grpc::ClientContext context;
    SetDeadline(context);
    v1::CancelJobRequest request;
    request.set_session_id("s");
    request.set_job_id(job);
    v1::CancelJobResponse response;
    const grpc::Status status = flattening().CancelJob(&context, request, &response);
    *after = response.job();
    return status;
  }
};

std::string WithoutTimes(v1::FlattenResponse response) {
  response.clear_queue_time();
  response.clear_solve_time();
  return response.SerializeAsString();
}

TEST_F(FlattenJobTest, AnswersWhatFlattenAnswers) {
  v1::FlattenRequest request = RequestFor(testing::SphereCap(60, 90, 1.2));
  for (const auto format : {v1::DRAWING_FORMAT_PDF, v1::DRAWING_FORMAT_SVG}) {
    request.add_drawings()->set_format(format);
  }
  v1::Job begun;
  ASSERT_TRUE(Submit("a", request, &begun).ok());
  EXPECT_EQ(begun.job_id(), "a");
  std::vector<v1::Job> told;
  ASSERT_TRUE(Watch("a", told).ok());
  ASSERT_FALSE(told.empty());
  EXPECT_TRUE(std::is_sorted(told.begin(), told.end(), [](const v1::Job& a, const v1::Job& b) {
    return a.fraction() < b.fraction();
  }));
  EXPECT_EQ(told.back().state(), v1::JOB_STATE_DONE);
  EXPECT_EQ(told.back().fraction(), 1);
  v1::FlattenResponse flat;
  ASSERT_TRUE(Get("a", &flat).ok());
  EXPECT_EQ(flat.drawings_size(), 2);
  EXPECT_EQ(WithoutTimes(flat), WithoutTimes(Flat(request)));
  EXPECT_EQ(Submit("a", request, &begun).error_code(), grpc::StatusCode::OK);
  EXPECT_EQ(begun.state(), v1::JOB_STATE_DONE) << "the same job";
}

TEST_F(FlattenJobTest, ResultsOfAnySizeComeInPieces) {
  v1::FlattenRequest request = RequestFor(testing::SphereCap(90, 120, 1.2));
  request.set_float64(true);
  const v1::Job done = Done("a", request);
  EXPECT_GT(done.result_bytes(), 300u << 10u) << "else this tests little";
  const auto bytes = Download("a");
  ASSERT_TRUE(bytes);
  EXPECT_EQ(bytes->size(), done.result_bytes());
  v1::FlattenResponse flat;
  ASSERT_TRUE(flat.ParseFromString(*bytes));
  EXPECT_EQ(WithoutTimes(flat), WithoutTimes(Flat(request)));
  EXPECT_EQ(Download("a", 1000), bytes->substr(1000)) << "after an interruption";
  EXPECT_EQ(Download("a", bytes->size()), "");
}

TEST_F(FlattenJobTest, AnswersThatAreTooLargeAreRefused) {
  v1::FlattenRequest request = RequestFor(testing::SphereCap(20, 30, 1.2));
  const v1::Job done = Done("a", request);
  v1::FlattenResponse flat;
  EXPECT_TRUE(Get("a", &flat, done.result_bytes()).ok());
  WireError error = ExpectError(Get("a", &flat, done.result_bytes() - 1),
                                grpc::StatusCode::RESOURCE_EXHAUSTED, "LIMIT_EXCEEDED");
  EXPECT_EQ(error.metadata["quota"], "max_response_bytes");

  // Flatten says so before the work where it is sure, else after it.
  request.set_max_response_bytes(1000);
  error = Refusal(request, grpc::StatusCode::RESOURCE_EXHAUSTED, "LIMIT_EXCEEDED");
  EXPECT_EQ(error.metadata["quota"], "max_response_bytes");
  const auto whole = static_cast<std::uint64_t>(Flat(RequestFor(BentStrip())).ByteSizeLong());
  request = RequestFor(BentStrip());
  request.set_max_response_bytes(whole + 100);  // the times may take more bytes
  Flat(request);
  request.set_max_response_bytes(whole / 2);
  Refusal(request, grpc::StatusCode::RESOURCE_EXHAUSTED, "LIMIT_EXCEEDED");
}

TEST_F(FlattenJobTest, WaitingJobsAreCancelled) {
  PoolGate gate(host().engine().jobs);
  ASSERT_TRUE(Submit("first", RequestFor(BentStrip())).ok());
  v1::Job second;
  ASSERT_TRUE(Submit("second", RequestFor(BentStrip()), &second).ok());
  EXPECT_EQ(second.state(), v1::JOB_STATE_WAITING);
  v1::Job after;
  ASSERT_TRUE(Cancel("second", &after).ok());
  EXPECT_EQ(after.state(), v1::JOB_STATE_CANCELLED);
  v1::FlattenResponse flat;
  ExpectError(Get("first", &flat), grpc::StatusCode::FAILED_PRECONDITION, "PROTOCOL");
  ExpectError(Get("second", &flat), grpc::StatusCode::CANCELLED, "CANCELLED");
  gate.Open();
  std::vector<v1::Job> told;
  ASSERT_TRUE(Watch("first", told).ok());
  EXPECT_EQ(told.back().state(), v1::JOB_STATE_DONE);
  told.clear();
  ASSERT_TRUE(Watch("second", told).ok());
  EXPECT_EQ(told.back().state(), v1::JOB_STATE_CANCELLED);
}

TEST_F(FlattenJobTest, FailuresAreThoseOfFlatten) {
  const v1::FlattenRequest ball = RequestFor(testing::Sphere(6, 8));
  EXPECT_EQ(Done("a", ball).state(), v1::JOB_STATE_FAILED);
  v1::FlattenResponse flat;
  const WireError error =
      ExpectError(Get("a", &flat), grpc::StatusCode::INVALID_ARGUMENT, "NOT_A_DISK");
  EXPECT_EQ(error.message, Refusal(ball, grpc::StatusCode::INVALID_ARGUMENT, "NOT_A_DISK").message);
  v1::FlattenRequest wrong = ball;
  wrong.set_refine(1'000'000);
  ExpectError(Submit("b", wrong), grpc::StatusCode::INVALID_ARGUMENT, "INVALID_OPTION");
  ExpectError(Get("b", &flat), grpc::StatusCode::NOT_FOUND, "NOT_FOUND");
}

TEST_F(FlattenJobTest, WatchersAreToldThatTheServerGoes) {
  PoolGate gate(host().engine().jobs);
  ASSERT_TRUE(Submit("a", RequestFor(BentStrip())).ok());
  grpc::ClientContext context;
  SetDeadline(context);
  v1::WatchJobRequest request;
  request.set_session_id("s");
  request.set_job_id("a");
  const auto reader = flattening().WatchJob(&context, request);
  v1::WatchJobResponse response;
  ASSERT_TRUE(reader->Read(&response));
  host().engine().streams.Drain();
  while (reader->Read(&response)) {
  }
  ExpectError(reader->Finish(), grpc::StatusCode::UNAVAILABLE, "DRAINING");
}

TEST_F(FlattenJobTest, TheClientLibraryWaitsForJobs) {
  const auto client = client::Client::Connect(host().addresses().front());
  const client::Session session = client.AttachSession("s");
  const SurfaceMesh mesh = testing::SphereCap(20, 30, 1.2);
  client::FlattenQuery query;
  query.float64 = true;
  auto job = session.SubmitFlatten("a", mesh, query);
  ASSERT_TRUE(job) << job.error().message;
  double fraction = 0;
  job = session.WatchJob("a", [&](const client::FlattenJob& now) {
    EXPECT_GE(now.fraction, fraction);
    fraction = now.fraction;
    return true;
  });
  ASSERT_TRUE(job) << job.error().message;
  EXPECT_EQ(job->state, client::JobState::kDone);
  const auto result = session.GetResult("a", mesh, query);
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(result->flat.uv, client.Flatten(mesh, query)->flat.uv);
  EXPECT_EQ(session.CancelJob("a")->state, client::JobState::kDone);
  EXPECT_EQ(session.WatchJob("a", [](const client::FlattenJob&) { return false; }).error().kind,
            FaultKind::kCancelled);
  EXPECT_EQ(session.GetResult("none", mesh).error().kind, FaultKind::kNotFound);
}

}  // namespace
}  // namespace arap::wire
