// Jobs of the client library: what a server may say of them, and what happens when it is lost while
// it does.
#include <chrono>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "arap/client/client.h"
#include "arap/v1/flattening_service.pb.h"
#include "tests/support/fake_server.h"

namespace arap::client {
namespace {

using std::chrono::milliseconds;
using testing::FakeServer;

const grpc::Status kGone(grpc::StatusCode::UNAVAILABLE, "Socket closed");

class JobsTest : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(session_.SubmitFlatten("j", surface_)); }

  Result<FlattenJob> Watch() {
    told_.clear();
    return session_.WatchJob("j", [this](const FlattenJob& job) {
      told_.push_back(job.state);
      return true;
    });
  }

  // What is said when a job stands like this, wherever that is answered.
  void ExpectRefused(const std::string& sentence, const std::function<void(v1::Job&)>& change) {
    const auto changed = [change](auto& answer) { change(*answer.mutable_job()); };
    server_.Change<v1::SubmitFlattenResponse>(changed);
    server_.Change<v1::WatchJobResponse>(changed);
    server_.Change<v1::CancelJobResponse>(changed);
    for (const auto& answer :
         {session_.SubmitFlatten("j", surface_), Watch(), session_.CancelJob("j")}) {
      ASSERT_FALSE(answer) << sentence;
      EXPECT_EQ(answer.error().kind, FaultKind::kInternal);
      EXPECT_EQ(answer.error().message, sentence);
    }
    EXPECT_TRUE(told_.empty());
  }

  FakeServer server_;
  Client client_ = Client::Connect(server_.address());
  Session session_ = client_.AttachSession("s");
  const SurfaceMesh surface_{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  std::vector<JobState> told_;
};

TEST_F(JobsTest, AreWatchedToTheEnd) {
  const auto ended = Watch();
  ASSERT_TRUE(ended) << ended.error().message;
  EXPECT_EQ(ended->state, JobState::kDone);
  EXPECT_EQ(told_, (std::vector{JobState::kWaiting, JobState::kRunning, JobState::kDone}));
  const auto result = session_.GetResult("j", surface_);
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(result->flat.uv, client_.Flatten(surface_)->flat.uv);
  EXPECT_EQ(session_.CancelJob("j")->state, JobState::kCancelled);
}

TEST_F(JobsTest, StandAsJobsCan) {
  ExpectRefused("The server answered the job \"other\", not \"j\".",
                [](v1::Job& job) { job.set_job_id("other"); });
  ExpectRefused("The server answered a job in no state that is known.",
                [](v1::Job& job) { job.clear_state(); });
  ExpectRefused("The server answered that 1.5 of a job is done.",
                [](v1::Job& job) { job.set_fraction(1.5); });
  ExpectRefused("The server answered that nan of a job is done.",
                [](v1::Job& job) { job.set_fraction(std::numeric_limits<double>::quiet_NaN()); });
}

TEST_F(JobsTest, ThatWereCancelledHaveEnded) {
  server_.Change<v1::CancelJobResponse>([](v1::CancelJobResponse& answer) {
    answer.mutable_job()->set_state(v1::JOB_STATE_RUNNING);
  });
  EXPECT_EQ(session_.CancelJob("j").error().kind, FaultKind::kInternal);
}

TEST_F(JobsTest, AreToldOfUntilTheyHaveEnded) {
  server_.Change<v1::WatchJobResponse>(
      [](v1::WatchJobResponse& answer) { answer.mutable_job()->set_state(v1::JOB_STATE_RUNNING); });
  EXPECT_EQ(Watch().error().message, "The server stopped telling of a job that has not ended.");
}

TEST_F(JobsTest, ResultsAreWholeAndFitTheSurface) {
  using Piece = v1::DownloadResultResponse;
  const auto refused = [&](std::function<void(Piece&)> change) {
    server_.Change<Piece>(std::move(change));
    const auto result = session_.GetResult("j", surface_);
    EXPECT_EQ(result ? FaultKind::kCancelled : result.error().kind, FaultKind::kInternal);
    return result ? std::string() : result.error().message;
  };
  const std::string misfit = "The server answered a result whose pieces do not fit.";
  EXPECT_EQ(refused([](Piece& piece) { piece.set_offset(piece.offset() + 1); }), misfit);
  EXPECT_EQ(refused([](Piece& piece) { piece.set_total_bytes(piece.offset() + 20); }), misfit);
  EXPECT_EQ(refused([](Piece& piece) { piece.set_total_bytes(5); }), misfit);
  EXPECT_EQ(refused([](Piece& piece) { piece.set_total_bytes(~std::uint64_t{0}); }), misfit);
  EXPECT_THAT(refused([](Piece& piece) { piece.set_total_bytes(10'000); }),
              ::testing::EndsWith("bytes of a result of 10000."));
  EXPECT_EQ(refused([](Piece& piece) { piece.mutable_data()->assign(piece.data().size(), '\7'); }),
            "The server answered a result that is none of a flattening.");
  server_.Change<Piece>([](Piece&) {});
  EXPECT_TRUE(session_.GetResult("j", surface_));
  const SurfaceMesh other{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 2, 1}}};
  EXPECT_FALSE(session_.GetResult("j", other)) << "of the surface that was submitted";
  EXPECT_FALSE(session_.GetResult("j", surface_, {.singular_values = true}));
}

TEST_F(JobsTest, ALostWatchIsBegunAgain) {
  server_.LoseTheAnswer("WatchJob", {kGone, kGone});
  const auto ended = Watch();
  ASSERT_TRUE(ended) << ended.error().message;
  EXPECT_EQ(server_.calls("WatchJob"), 3);
  EXPECT_EQ(told_.size(), 5u);
}

TEST_F(JobsTest, ALostDownloadGoesOnWhereItWas) {
  server_.LoseTheAnswer("DownloadResult", {kGone, kGone, kGone});
  const auto result = session_.GetResult("j", surface_);
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(server_.calls("DownloadResult"), 4);
}

TEST_F(JobsTest, LostCallsThatDoNoHarmTwiceAreMadeAgain) {
  server_.LoseTheAnswer("SubmitFlatten", {kGone});
  EXPECT_TRUE(session_.SubmitFlatten("k", surface_));
  server_.LoseTheAnswer("CancelJob", {kGone});
  EXPECT_TRUE(session_.CancelJob("k"));
  EXPECT_EQ(server_.calls("CancelJob"), 2);
}

TEST_F(JobsTest, NothingIsBegunAgainForEver) {
  server_.Refuse("WatchJob", std::vector<grpc::Status>(100, kGone));
  const auto gone = session_.WatchJob("j", {}, {.retry_within = milliseconds(0)});
  ASSERT_FALSE(gone);
  EXPECT_EQ(gone.error().kind, FaultKind::kDraining);
  EXPECT_EQ(server_.calls("WatchJob"), 1);
}

TEST_F(JobsTest, WhoStopsWatchingIsNotToldAnyMore) {
  int told = 0;
  const auto stopped = session_.WatchJob("j", [&](const FlattenJob&) { return ++told < 2; });
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, FaultKind::kCancelled);
  EXPECT_EQ(told, 2);
  EXPECT_EQ(server_.calls("WatchJob"), 1);
}

TEST_F(JobsTest, ASilentServerIsGivenUp) {
  server_.Hush("WatchJob");
  const auto silent = session_.WatchJob("j", {}, {.timeout = milliseconds(100)});
  ASSERT_FALSE(silent);
  EXPECT_EQ(silent.error().kind, FaultKind::kDeadlineExceeded);
}

}  // namespace
}  // namespace arap::client
