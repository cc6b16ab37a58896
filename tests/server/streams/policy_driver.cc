#include "tests/server/streams/policy_driver.h"

#include <array>
#include <limits>
#include <string>

#include "arap/core/registered_mesh.h"
#include "tests/fuzz/bytes.h"

namespace arap::testing {
namespace {

using app::StreamAnswer;
using app::StreamMessage;
using Work = app::StreamJob::Work;

// Counts those that are kept.
struct CountedAnswer final : app::WireAnswer {
  explicit CountedAnswer(std::size_t& count) : count_(count) { ++count_; }
  ~CountedAnswer() override { --count_; }
  std::size_t& count_;
};

Handle AtVertex(const char* id, std::uint32_t vertex) { return {id, VertexAnchor{vertex}}; }

// A grid of so many squares in each direction.
std::shared_ptr<const RegisteredMesh> Grid(std::uint32_t squares) {
  PlanarMesh grid;
  for (std::uint32_t y = 0; y <= squares; ++y) {
    for (std::uint32_t x = 0; x <= squares; ++x) grid.vertices.emplace_back(x, y);
  }
  for (std::uint32_t y = 0; y < squares; ++y) {
    for (std::uint32_t x = 0; x < squares; ++x) {
      const std::uint32_t corner = (squares + 1) * y + x;
      const std::uint32_t above = corner + squares + 1;
      grid.triangles.push_back({corner, corner + 1, above + 1});
      grid.triangles.push_back({corner, above + 1, above});
    }
  }
  return *RegisteredMesh::Register(std::move(grid), {});
}

std::shared_ptr<const CompiledHandles> Compile(std::vector<Handle> handles) {
  static const std::shared_ptr<const RegisteredMesh> mesh = Grid(4);
  return *CompiledHandles::Compile(mesh, std::move(handles));
}

}  // namespace

std::shared_ptr<const CompiledHandles> ThreeCorners() {
  static const auto set = Compile({AtVertex("a", 0), AtVertex("b", 4), AtVertex("c", 20)});
  return set;
}

std::shared_ptr<const CompiledHandles> WithoutB() {
  static const auto set = Compile({AtVertex("a", 0), AtVertex("c", 20), AtVertex("d", 12)});
  return set;
}

std::shared_ptr<const CompiledHandles> ManyRows() {
  static const auto set = [] {
    std::vector<Handle> handles;
    for (std::uint32_t i = 0; i < 100; ++i) {
      handles.push_back(AtVertex(("h" + std::to_string(i)).c_str(), 100 * i));
    }
    return *CompiledHandles::Compile(Grid(150), std::move(handles));
  }();
  return set;
}

std::unique_ptr<app::WireAnswer> PolicyDriver::NewAnswer() {
  return std::make_unique<CountedAnswer>(answers_kept);
}

void PolicyDriver::Send(decltype(StreamMessage::payload) payload, std::size_t bytes) {
  Expect(reading, "a message comes only when one is read");
  reading = false;
  policy.MessageRead({bytes, std::move(payload)});
  Pump();
}

void PolicyDriver::Packed(std::uint64_t sequence, std::vector<double> positions) {
  positions_.push_back(std::make_unique<std::vector<double>>(std::move(positions)));
  Send(StreamMessage::Update{sequence, {}, *positions_.back(), {}});
}

void PolicyDriver::HalfClose() {
  reading = false;
  policy.HalfClosed();
  Pump();
}

void PolicyDriver::FinishJob(bool latest) {
  switch (job->work) {
    case Work::kOpen:
      if (auto admitted = policy.AdmitFrames(frame_seconds); !admitted) {
        policy.Failed(std::move(admitted.error()));
        break;
      }
      policy.Opened(
          {set, set->RestTargets()}, latest, measure_every,
          [this]() -> Status {
            ++touched;
            if (session_over) return Fail(FaultKind::kNotFound, "The session is over.");
            return {};
          },
          NewAnswer());
      break;
    case Work::kUpdate:
      policy.FrameTook(frame_seconds);
      policy.Moved(NewAnswer());
      break;
    case Work::kEdit:
      set = set == WithoutB() ? ThreeCorners() : WithoutB();
      policy.Edited({set, set->RestTargets()}, NewAnswer());
      break;
  }
  job.reset();
  Pump();
}

void PolicyDriver::FailJob(Fault fault) {
  job.reset();
  policy.Failed(std::move(fault));
  Pump();
}

void PolicyDriver::FinishWrite(bool ok) {
  writing.reset();
  policy.Written(ok);
  Pump();
}

void PolicyDriver::End(Fault reason) {
  policy.End(std::move(reason));
  Pump();
}

void PolicyDriver::Cancel() {
  policy.Cancelled();
  Pump();
}

bool PolicyDriver::Sweep() {
  const bool cancel = policy.Sweep(clock.SteadyNow());
  Pump();
  return cancel;
}

void PolicyDriver::OpenAndAnswer(bool latest) {
  Open();
  FinishJob(latest);
  FinishWrite();
}

void PolicyDriver::Pump() {
  for (;;) {
    app::StreamStep step = policy.Next();
    if (std::holds_alternative<std::monostate>(step)) break;
    Expect(!finished, "nothing comes after the end");
    if (std::holds_alternative<app::StreamRead>(step)) {
      Expect(!reading, "one read at a time");
      reading = true;
    } else if (auto* start = std::get_if<app::StreamJob>(&step)) {
      Expect(!job, "one job at a time");
      if (no_room) {
        policy.NoRoom();
      } else {
        job = std::move(*start);
      }
    } else if (auto* write = std::get_if<app::StreamWrite>(&step)) {
      Expect(!writing, "one write at a time");
      writing = std::move(write->answer);
    } else {
      Expect(!job && !writing, "the end waits for the job and the write");
      finished = std::get<app::StreamFinish>(step).status;
    }
  }
  Expect(answers_kept <= 2, "a slow reader costs the write and one answer");
  Expect(finished || reading || job || writing, "the stream does not get stuck");
}

namespace {

// Events from bytes, and what must be true of the answers to them.
class Drive {
 public:
  Drive(const std::uint8_t* data, std::size_t size) : bytes_(data, size) {
    every_ = bytes_.Coin();
    driver_.measure_every = bytes_.Below(4);
  }

  std::string Run() {
    if (bytes_.Coin()) {
      driver_.Open();
      FinishJob();
    }
    while (!bytes_.empty() && !driver_.finished && broken().empty()) Event(bytes_.Below(16));
    // Whatever has happened: it comes to an end.
    if (driver_.reading) driver_.HalfClose();
    for (int i = 0; i < 100 && !driver_.finished && broken().empty(); ++i) {
      if (driver_.job) {
        FinishJob();
      } else if (driver_.writing) {
        FinishWrite(true);
      } else if (driver_.reading) {
        driver_.HalfClose();
      }
    }
    Expect(driver_.finished.has_value(), "every stream ends");
    if (driver_.finished && *driver_.finished) {
      // What an update that failed had replaced is counted by the next shape, if there is one.
      Expect(answered_ == sent_ || (some_failed_ && answered_ < sent_),
             "at a good end every update and edit is answered or replaced");
    }
    return broken();
  }

 private:
  const std::string& broken() const { return driver_.broken.empty() ? broken_ : driver_.broken; }
  void Expect(bool kept, const char* promise) {
    if (!kept && broken_.empty()) broken_ = promise;
  }

  void Event(std::uint32_t event) {
    switch (event) {
      case 0:
        driver_.no_room = bytes_.Coin();
        some_failed_ |= driver_.no_room;
        return;
      case 1:
        driver_.too_busy.reset();
        if (bytes_.Coin()) driver_.too_busy = Fault(FaultKind::kLimitExceeded, "Too busy.");
        return;
      case 2:
        driver_.Advance(std::chrono::milliseconds(10 * bytes_.Byte()));
        static_cast<void>(driver_.Sweep());
        return;
      case 3:
        // Seldom, or few streams would get far.
        if (bytes_.Byte() < 250) return;
        bytes_.Coin() ? driver_.Cancel() : driver_.End(Fault(FaultKind::kDraining, "Draining."));
        return;
      case 4:
        driver_.session_over = bytes_.Byte() > 250;
        return;
      case 5:
        if (driver_.job && driver_.job->work != Work::kOpen) {
          some_failed_ = true;
          driver_.FailJob(Fault(FaultKind::kNumerical, "No finite shape."));
        }
        return;
      case 6:
      case 7:
        if (driver_.job) FinishJob();
        return;
      case 8:
      case 9:
        if (driver_.writing) FinishWrite(bytes_.Byte() < 254);
        return;
      case 10:
        if (driver_.reading && bytes_.Byte() > 240) driver_.HalfClose();
        return;
      default:
        if (driver_.reading) Message();
        return;
    }
  }

  void Message() {
    switch (bytes_.Below(16)) {
      case 0:
        return driver_.Send(std::monostate());
      case 1:
        return driver_.Open();
      case 2:
        return driver_.Send(StreamMessage::Ping{}, bytes_.Byte() > 250 ? kTooMany : 1);
      case 3:
      case 4:
        return driver_.Ping(bytes_.Byte());
      case 5:
        driver_.Edit(++sent_, bytes_.Below(8), bytes_.Coin());
        return;
      case 6: {
        std::vector<double> positions(bytes_.Below(8));
        for (double& number : positions) number = bytes_.Number();
        driver_.Packed(++sent_, std::move(positions));
        return;
      }
      default:
        break;
    }
    static constexpr std::array<const char*, 5> kIds = {"a", "b", "c", "d", "nobody"};
    StreamMessage::Update update;
    update.sequence = ++sent_;
    for (std::uint32_t i = bytes_.Below(5); i > 0; --i) {
      update.targets.push_back({kIds[bytes_.Below(static_cast<std::uint32_t>(kIds.size()))],
                                {{bytes_.Number(), bytes_.Number()}, 0, 1}});
    }
    update.measure = bytes_.Byte() > 200;
    if (bytes_.Byte() > 250) update.picks = Fail(FaultKind::kArrayLength, "An odd length.");
    driver_.Send(std::move(update));
  }

  void FinishJob() {
    if (!driver_.job) return;
    const auto& targets = driver_.job->targets;
    Expect(driver_.job->work == Work::kOpen || targets.size() == driver_.set->handles().size(),
           "a job has one target per handle");
    driver_.FinishJob(!every_);
  }

  void FinishWrite(bool ok) {
    const StreamAnswer& answer = *driver_.writing;
    if (answer.kind == StreamAnswer::Kind::kShape || answer.kind == StreamAnswer::Kind::kError) {
      answered_ += answer.replaced + 1;
      Expect(answer.sequence > last_, "answers keep the order of the messages");
      Expect(answer.sequence <= sent_, "an answer answers something");
      Expect(!every_ || answer.replaced == 0, "EVERY replaces nothing");
      last_ = answer.sequence;
    }
    if (answer.kind == StreamAnswer::Kind::kShape) {
      unmeasured_ = answer.measured ? 0 : unmeasured_ + 1;
      const std::uint32_t measure_every = driver_.measure_every;
      Expect(measure_every == 0 || unmeasured_ < measure_every,
             "of so many shapes in a row one is measured");
    }
    driver_.FinishWrite(ok);
  }

  static constexpr std::size_t kTooMany = std::numeric_limits<std::size_t>::max();

  fuzz::Bytes bytes_;
  PolicyDriver driver_{SmallLimits()};
  bool every_ = false;
  std::uint64_t sent_ = 0;
  std::uint64_t answered_ = 0;    // or replaced
  std::uint64_t last_ = 0;        // that was answered
  std::uint32_t unmeasured_ = 0;  // shapes since the last measured one
  bool some_failed_ = false;      // jobs that had started, or should have
  std::string broken_;

  // So that rate and idleness are met.
  static Limits SmallLimits() {
    Limits limits;
    limits.max_stream_fps = 20;
    limits.max_stream_idle = std::chrono::seconds(20);
    return limits;
  }
};

}  // namespace

std::string DrivePolicy(const std::uint8_t* data, std::size_t size) {
  return Drive(data, size).Run();
}

}  // namespace arap::testing
