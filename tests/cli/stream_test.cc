// Live streams of the client library against a private server.

#include <gmock/gmock.h>

#include "tests/cli/server_test.h"
#include "tests/support/bounded.h"

namespace arap::cli {
namespace {

using client::DeformStream;
using client::Delivery;
using client::StreamEvent;
using ::testing::SizeIs;

class Stream : public ServerTest {
 protected:
  // A stream on the two handles of the small mesh.
  DeformStream Open(Delivery delivery) {
    session_ = NewSession();
    Compile(*session_, "set");
    auto stream = session_->OpenStream("set", {.delivery = delivery}, {std::chrono::seconds(60)});
    EXPECT_TRUE(stream) << stream.error().message;
    return *std::move(stream);
  }

  // The next event, which has to be a T.
  template <class T>
  static T Next(DeformStream& stream) {
    Result<std::optional<StreamEvent>> event = stream.Read();
    EXPECT_TRUE(event) << event.error().message;
    EXPECT_TRUE(event && *event);
    if (!event || !*event || !std::holds_alternative<T>(**event)) {
      ADD_FAILURE() << "another kind of event";
      return {};
    }
    return std::get<T>(**std::move(event));
  }

  std::optional<client::Session> session_;
};

TEST_F(Stream, AnswersUpdatesEditsAndPings) {
  DeformStream stream = Open(Delivery::kEvery);
  EXPECT_THAT(stream.handle_set().handles, SizeIs(2));

  ASSERT_TRUE(stream.Send({1, {{"right", {{8, 1}}}}, {}, {}}));
  const auto first = Next<client::Shape>(stream);
  EXPECT_EQ(first.sequence, 1u);
  EXPECT_EQ(first.positions.size(), Mesh().vertices.size());
  EXPECT_NEAR(first.positions[8].imag(), 1, 1e-4);

  ASSERT_TRUE(stream.Ping(42));
  EXPECT_EQ(Next<client::Pong>(stream).nonce, 42u);

  const client::Handle top{"top", client::PointAnchor{{4, 7.5}}};
  ASSERT_TRUE(stream.Edit(2, std::vector<std::string>{"left"}, std::vector{top}));
  const auto edited = Next<client::Shape>(stream);
  EXPECT_EQ(edited.sequence, 2u);
  EXPECT_GT(edited.handle_set_revision, first.handle_set_revision);

  ASSERT_TRUE(stream.Send({3, {}, {{0, 0}, {0, 8}}, {}}));
  EXPECT_EQ(Next<client::Shape>(stream).sequence, 3u);

  ASSERT_TRUE(stream.CloseSending());
  EXPECT_EQ(stream.Send({4, {}, {}, {}}).error().kind, FaultKind::kProtocol);
  const auto end = stream.Read();
  ASSERT_TRUE(end) << end.error().message;
  EXPECT_FALSE(*end);
  const auto again = stream.Read();  // repeats itself
  ASSERT_TRUE(again);
  EXPECT_FALSE(*again);
}

TEST_F(Stream, GoesOnAfterABadUpdate) {
  DeformStream stream = Open(Delivery::kEvery);
  ASSERT_TRUE(stream.Send({1, {{"nobody", {{0, 0}}}}, {}, {}}));
  const auto error = Next<client::UpdateError>(stream);
  EXPECT_EQ(error.sequence, 1u);
  EXPECT_EQ(error.fault.kind, FaultKind::kUnknownHandle);
  ASSERT_TRUE(stream.Send({2, {{"left", {{0, std::numeric_limits<double>::infinity()}}}}, {}, {}}));
  EXPECT_EQ(Next<client::UpdateError>(stream).fault.kind, FaultKind::kNonFiniteTarget);
  ASSERT_TRUE(stream.Send({3, {{"left", {{0, 0}}}}, {}, {}}));
  EXPECT_EQ(Next<client::Shape>(stream).sequence, 3u);
}

TEST_F(Stream, OneThreadReadsWhileOthersSend) {
  constexpr std::uint64_t kUpdates = 200;
  DeformStream stream = Open(Delivery::kEvery);
  testing::BoundedThread writer("the sender", [&] {
    for (std::uint64_t i = 1; i <= kUpdates; ++i) {
      EXPECT_TRUE(stream.Send({i, {{"right", {{8, static_cast<double>(i) / 100}}}}, {}, {}}));
    }
    EXPECT_TRUE(stream.CloseSending());
  });
  std::uint64_t answered = 0;
  for (auto event = stream.Read(); event && *event; event = stream.Read()) {
    EXPECT_EQ(std::get<client::Shape>(**event).sequence, ++answered);
  }
  writer.Join();
  EXPECT_EQ(answered, kUpdates);
}

TEST_F(Stream, CancelFreesAReader) {
  DeformStream stream = Open(Delivery::kLatest);
  testing::BoundedThread other("the one that cancels", [&] { stream.Cancel(); });
  const auto event = stream.Read();
  other.Join();
  ASSERT_FALSE(event);
  EXPECT_EQ(event.error().kind, FaultKind::kCancelled);
  const Status sent = stream.Send({1, {}, {}, {}});
  ASSERT_FALSE(sent);
  EXPECT_EQ(sent.error().kind, FaultKind::kProtocol);
}

TEST_F(Stream, CanBeDroppedAtAnyTime) {
  DeformStream stream = Open(Delivery::kEvery);
  ASSERT_TRUE(stream.Send({1, {{"right", {{8, 1}}}}, {}, {}}));
}

TEST_F(Stream, OnAnUnknownHandleSetDoesNotOpen) {
  const auto stream = NewSession().OpenStream("nothing", {.delivery = Delivery::kEvery});
  ASSERT_FALSE(stream);
  EXPECT_EQ(stream.error().kind, FaultKind::kNotFound);
}

TEST_F(Stream, EndsWhenTheSessionIsDeleted) {
  DeformStream stream = Open(Delivery::kEvery);
  ASSERT_TRUE(session_->Delete());
  (void)stream.Send({1, {{"right", {{8, 1}}}}, {}, {}});
  Result<std::optional<StreamEvent>> event = stream.Read();
  while (event && *event) event = stream.Read();
  ASSERT_FALSE(event);
  EXPECT_EQ(event.error().kind, FaultKind::kNotFound);
}

}  // namespace
}  // namespace arap::cli
