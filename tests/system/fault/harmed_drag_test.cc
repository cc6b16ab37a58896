// Servers are killed, drained and frozen under a running drag of the client library and of arapctl:
// nobody sees an error, the last shape is right, and what was lost is counted.
//
// ARAP_RESUME_ROUNDS says how often one stream is harmed.
#include <atomic>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "arap/client/client.h"
#include "client/cli/sample/samples.h"
#include "core/files/mesh_file.h"
#include "core/files/obj_writer.h"
#include "core/files/text_file.h"
#include "core/files/track.h"
#include "tests/support/bounded.h"
#include "tests/system/fault/harm.h"

namespace arap::fault {
namespace {

using client::DeformStream;
using client::Delivery;
using client::StreamEvent;
using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;
using testing::Await;
using ::testing::HasSubstr;

class LostServerTest : public ::testing::Test {
 protected:
  void SetUp() override {
    server_.emplace(std::vector<std::string>{"--store", "sqlite:{}/state"}, "unix:{}/socket");
    ASSERT_TRUE(server_->Start());
  }

  std::optional<ServerProcess> server_;
};

class HarmedDragTest : public LostServerTest, public ::testing::WithParamInterface<Harm> {
 protected:
  // Only a frozen server has to be noticed by its silence; a busy machine may be silent for longer.
  static milliseconds Silence() { return GetParam() == Harm::kFreeze ? seconds(2) : seconds(60); }
};

INSTANTIATE_TEST_SUITE_P(Harms, HarmedDragTest,
                         ::testing::Values(Harm::kKill, Harm::kDrain, Harm::kFreeze),
                         [](const auto& tested) { return NameOf(tested.param); });

// Moves a handle of two now and then, for as long as it is told, and reads what comes back.
class Dragger {
 public:
  explicit Dragger(DeformStream stream)
      : stream_(std::move(stream)),
        reader_("the reader of a harmed stream", [this] { Read(); }),
        sender_("the sender on a harmed stream", [this] { Send(); }) {}

  // The last shape: both handles where `last` says. Once.
  client::Shape Finish(Complex left, Complex right) {
    last_ = {left, right};
    {
      const std::lock_guard lock(mutex_);
      done_ = true;
    }
    wake_.notify_all();
    sender_.Join();
    reader_.Join();
    return std::move(shape_);
  }

  bool failed() const { return failed_; }
  std::size_t sent() const { return sent_; }
  std::size_t answered() const { return answered_; }
  std::size_t resumed() const { return resumed_; }
  std::size_t lost() const { return lost_; }          // around a loss, without an answer
  std::size_t replaced() const { return replaced_; }  // by newer ones, else

 private:
  void Fail(const std::string& what) {
    ADD_FAILURE() << what;
    failed_ = true;
  }

  void Send() {
    std::unique_lock lock(mutex_);
    for (std::uint64_t sequence = 1;; ++sequence) {
      client::HandleUpdate update;
      update.sequence = sequence;
      const bool right = sequence % 2 == 1;
      const Complex at{right ? 8.0 : 0.0, std::sin(static_cast<double>(sequence) / 50)};
      update.targets = {{right ? "r" : "l", {at}}};
      const bool last = done_;
      if (last) update.targets = {{"l", {last_[0]}}, {"r", {last_[1]}}};
      lock.unlock();
      const Status sent = stream_.Send(update);
      if (!sent) return Fail("send: " + sent.error().message);
      ++sent_;
      if (last) {
        EXPECT_TRUE(stream_.CloseSending());
        return;
      }
      lock.lock();
      wake_.wait_for(lock, milliseconds(2), [this] { return done_; });
    }
  }

  void Read() {
    std::uint64_t before = 0;
    for (bool gap = false;;) {
      Result<std::optional<StreamEvent>> event = stream_.Read();
      if (!event) return Fail("read: " + event.error().message);
      if (!*event) return;
      if (std::holds_alternative<client::Resumed>(**event)) {
        ++resumed_;
        gap = true;
      } else if (auto* shape = std::get_if<client::Shape>(&**event)) {
        if (shape->sequence <= before) return Fail("an answer came twice");
        (gap ? lost_ : replaced_) += shape->sequence - before - 1;
        gap = false;
        before = shape->sequence;
        shape_ = std::move(*shape);
        ++answered_;
      } else {
        return Fail("another event");
      }
    }
  }

  DeformStream stream_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool done_ = false;
  std::array<Complex, 2> last_{};  // before done_
  client::Shape shape_;            // the reader's
  std::atomic<bool> failed_ = false;
  std::atomic<std::size_t> sent_ = 0, answered_ = 0, resumed_ = 0, lost_ = 0, replaced_ = 0;
  testing::BoundedThread reader_, sender_;
};

TEST_P(HarmedDragTest, OfTheClientLibraryGoesOn) {
  auto session = client::Client::Connect(server_->address()).CreateSession();
  ASSERT_TRUE(session) << session.error().message;
  ASSERT_TRUE(session->RegisterMesh(cli::MakeGrid(9, 9), {}, "m"));
  const std::vector<client::Handle> handles{{"l", client::VertexAnchor{0}},
                                            {"r", client::VertexAnchor{8}}};
  ASSERT_TRUE(session->CompileHandles("h", "m", handles));
  const Complex left{-1, 0}, right{9, 1};
  const std::vector<client::HandleTarget> last{{"l", {left}}, {"r", {right}}};
  for (const Delivery delivery : {Delivery::kLatest, Delivery::kEvery}) {
    client::ShapeOptions shape;
    shape.float64 = true;
    const auto expected = session->Deform("h", last, shape);
    ASSERT_TRUE(expected) << expected.error().message;

    client::StreamOptions options{delivery, shape};
    options.heartbeat = milliseconds(200);
    options.silence = Silence();
    options.resume_within = minutes(5);
    auto stream = session->OpenStream("h", options);
    ASSERT_TRUE(stream) << stream.error().message;
    Dragger drag(*std::move(stream));
    for (std::size_t round = 0; round < Rounds() && !HasFailure(); ++round) {
      SCOPED_TRACE(fmt::format("round {}", round));
      EXPECT_TRUE(Do(GetParam(), *server_));
      EXPECT_TRUE(
          Await("the stream resumes", [&] { return drag.failed() || drag.resumed() > round; }));
      const std::size_t answered = drag.answered();
      EXPECT_TRUE(Await("a shape", [&] { return drag.failed() || drag.answered() > answered; }));
    }
    const client::Shape end = drag.Finish(left, right);
    EXPECT_EQ(end.sequence, drag.sent());
    EXPECT_EQ(end.positions, expected->positions);
    EXPECT_GE(drag.resumed(), Rounds());
    EXPECT_EQ(drag.answered() + drag.replaced() + drag.lost(), drag.sent());
    if (delivery == Delivery::kEvery) {
      EXPECT_EQ(drag.answered(), drag.sent());
    }
    std::printf(
        "%s, %s: %zu updates sent, %zu answered, %zu replaced by newer ones, %zu lost, %zu "
        "times resumed\n",
        NameOf(GetParam()), delivery == Delivery::kEvery ? "every" : "latest", drag.sent(),
        drag.answered(), drag.replaced(), drag.lost(), drag.resumed());
  }
}

// arapctl with its output in a pipe, which holds a few of its rows: who does not read it stops it.
class HarmedCommand {
 public:
  HarmedCommand(const TempFolder& folder, const std::string& address, std::size_t frames,
                std::vector<std::string> more)
      : folder_(folder) {
    const PlanarMesh mesh = cli::MakeGrid(33, 33);
    Track track = cli::MakeGridTrack(mesh, 33, 33);
    const std::vector<TrackFrame> some = track.frames;
    while (track.frames.size() < frames) {
      track.frames.insert(track.frames.end(), some.begin(), some.end());
    }
    track.frames.resize(frames);
    EXPECT_TRUE(WriteTextFile(folder / "grid.obj", FormatObj(mesh)));
    EXPECT_TRUE(WriteTextFile(folder / "grid.json", FormatTrack(track)));
    words_ = {
        ARAPCTL, "drag",   folder / "grid.obj",  folder / "grid.json", "--server", address, "--out",
        "-",     "--json", folder / "times.json"};
    words_.insert(words_.end(), more.begin(), more.end());
    EXPECT_TRUE(child_.Launch(words_, folder_ / "said"));
  }

  // The next row; nothing at the end.
  std::optional<std::string> Row() { return child_.ReadLine("", testing::kLongest); }
  std::optional<int> Wait() { return child_.Wait(testing::kLongest); }
  std::string Said() const { return Text("said"); }
  nlohmann::json Times() const { return nlohmann::json::parse(Text("times.json"), nullptr, false); }

 private:
  std::string Text(const std::string& name) const {
    return ReadTextFile(folder_ / name).value_or("");
  }

  const TempFolder& folder_;
  std::vector<std::string> words_;
  ChildProcess child_;
};

// All rows from the next one on; the program has to end well.
void ReadOn(HarmedCommand& command, std::vector<std::string>& rows) {
  while (auto row = command.Row()) rows.push_back(*std::move(row));
  EXPECT_EQ(command.Wait(), 0) << command.Said();
}

TEST_P(HarmedDragTest, OfArapctlGoesOnAndSaysSo) {
  const std::string silence = std::to_string(Silence().count() / 1000);
  for (const std::string delivery : {"every", "latest"}) {
    SCOPED_TRACE(delivery);
    const bool every = delivery == "every";
    const std::vector<std::string> words{"--delivery", delivery, "--rate",    "200",
                                         "--resume",   "300",    "--silence", silence};
    // A machine that stands still may let the track of LATEST end before the harm: then a longer
    // one.
    for (std::size_t frames = 200; frames <= 3200; frames *= 2) {
      const TempFolder calm, harmed;
      HarmedCommand undisturbed(calm, server_->address(), frames, {"--delivery", "every"});
      std::vector<std::string> expected, rows;
      ReadOn(undisturbed, expected);
      ASSERT_EQ(expected.size(), frames + 1);

      HarmedCommand command(harmed, server_->address(), frames, words);
      for (int row = 0; row < 3; ++row) rows.push_back(command.Row().value_or(""));
      std::optional<testing::BoundedThread> reader;
      const bool done = Do(GetParam(), *server_, [&] {
        reader.emplace("the rows of arapctl", [&] { ReadOn(command, rows); });
      });
      reader.reset();
      ASSERT_TRUE(done);
      const nlohmann::json times = command.Times();
      ASSERT_TRUE(times.is_object());
      if (!every && times["resumed"] == 0) continue;

      EXPECT_GE(times["resumed"], 1);
      EXPECT_THAT(command.Said(),
                  HasSubstr("arapctl: warning: stream_resumed: The stream was lost"));
      EXPECT_THAT(command.Said(), ::testing::ContainsRegex("frames? lost"));
      EXPECT_EQ(times["sent"], frames);
      EXPECT_EQ(times["answered"].get<std::size_t>() + times["replaced"].get<std::size_t>() +
                    times["lost"].get<std::size_t>(),
                frames);
      if (every) {
        EXPECT_EQ(rows, expected);
        EXPECT_EQ(times["lost"], 0);
      } else {
        EXPECT_EQ(rows.back(), expected.back());
        EXPECT_EQ(rows.size() - 1, times["answered"]);
      }
      break;
    }
  }
}

TEST_F(LostServerTest, EndsADragOfArapctlThatIsNotToResume) {
  const TempFolder folder;
  HarmedCommand command(folder, server_->address(), 400, {"--delivery", "every", "--resume", "0"});
  ASSERT_TRUE(command.Row());
  server_->Kill();
  while (command.Row()) {
  }
  EXPECT_EQ(command.Wait(), 6) << command.Said();
  EXPECT_THAT(command.Said(), HasSubstr("arapctl: DRAINING: "));
}

}  // namespace
}  // namespace arap::fault
