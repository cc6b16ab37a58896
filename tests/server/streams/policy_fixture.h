// PolicyTest: a stream's policy with its driver, and what is expected of it. DeliveryTest is the
// same for LATEST and for EVERY, its parameter.
#pragma once

#include <cstdint>
#include <string>

#include <gtest/gtest.h>

#include "server/streams/stream_policy.h"
#include "tests/server/streams/policy_driver.h"

namespace arap::testing {

inline constexpr bool kLatest = true;
inline constexpr bool kEvery = false;

inline app::NamedTarget At(const char* id, double x, double y) { return {id, {{x, y}, 0, 1}}; }

class PolicyTest : public ::testing::Test {
 protected:
  void TearDown() override { EXPECT_EQ(stream_.broken, ""); }

  void ExpectEnd(FaultKind kind) {
    ASSERT_TRUE(stream_.finished.has_value()) << "the stream goes on";
    ASSERT_FALSE(stream_.finished->has_value()) << "the stream has ended well";
    EXPECT_EQ(stream_.finished->error().kind, kind) << stream_.finished->error().message;
  }
  void ExpectGoodEnd() {
    ASSERT_TRUE(stream_.finished.has_value()) << "the stream goes on";
    EXPECT_TRUE(stream_.finished->has_value()) << stream_.finished->error().message;
  }
  // The answer that is being written, and the end of the write.
  void ExpectShape(std::uint64_t sequence, std::uint64_t replaced = 0) {
    ASSERT_TRUE(stream_.writing.has_value()) << "no answer to " << sequence;
    EXPECT_EQ(stream_.writing->kind, app::StreamAnswer::Kind::kShape);
    EXPECT_EQ(stream_.writing->sequence, sequence);
    EXPECT_EQ(stream_.writing->replaced, replaced);
    stream_.FinishWrite();
  }
  void ExpectError(std::uint64_t sequence, FaultKind kind, const std::string& field = {}) {
    ASSERT_TRUE(stream_.writing.has_value()) << "no answer to " << sequence;
    ASSERT_EQ(stream_.writing->kind, app::StreamAnswer::Kind::kError);
    EXPECT_EQ(stream_.writing->sequence, sequence);
    EXPECT_EQ(stream_.writing->fault->kind, kind) << stream_.writing->fault->message;
    if (!field.empty()) {
      EXPECT_EQ(stream_.writing->fault->field, field);
    }
    stream_.FinishWrite();
  }
  void ExpectPong(std::uint64_t nonce) {
    ASSERT_TRUE(stream_.writing.has_value());
    EXPECT_EQ(stream_.writing->kind, app::StreamAnswer::Kind::kPong);
    EXPECT_EQ(stream_.writing->nonce, nonce);
    stream_.FinishWrite();
  }
  // The job that runs is the update of this number.
  void ExpectUpdateJob(std::uint64_t sequence) {
    ASSERT_TRUE(stream_.job.has_value()) << "update " << sequence << " has not started";
    EXPECT_EQ(stream_.job->work, app::StreamJob::Work::kUpdate);
    EXPECT_EQ(stream_.job->lane, app::StreamJob::Lane::kFrames);
    EXPECT_EQ(stream_.job->sequence, sequence);
  }

  PolicyDriver stream_;
};

class DeliveryTest : public PolicyTest, public ::testing::WithParamInterface<bool> {
 protected:
  void SetUp() override { stream_.OpenAndAnswer(GetParam()); }
};

}  // namespace arap::testing
