// PolicyDriver: a StreamPolicy with somebody who does what it says, one event at a time. No wire,
// no threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/streams/stream_policy.h"
#include "tests/support/fake_clock.h"

namespace arap::testing {

// A square of 4 × 4 with the handles "a", "b" and "c" in corners, at (0, 0), (4, 0) and (0, 4); and
// what an edit makes of it: "b" gone, "d" added in the middle, at (2, 2).
std::shared_ptr<const CompiledHandles> ThreeCorners();
std::shared_ptr<const CompiledHandles> WithoutB();
// A hundred handles on 23,000 vertices: mesh and handles are factored together.
std::shared_ptr<const CompiledHandles> ManyRows();

class PolicyDriver {
 public:
  explicit PolicyDriver(const Limits& the_limits = {}) : limits(the_limits) { Pump(); }

  // The client, when `reading`.
  void Send(decltype(app::StreamMessage::payload) payload, std::size_t bytes = 10);
  void Open() { Send(app::StreamMessage::Open{}); }
  void Update(std::uint64_t sequence, std::vector<app::NamedTarget> targets = {},
              std::vector<Complex> picks = {}) {
    Send(app::StreamMessage::Update{sequence, std::move(targets), {}, std::move(picks)});
  }
  // The positions stay as they are for as long as the driver does.
  void Packed(std::uint64_t sequence, std::vector<double> positions);
  void Edit(std::uint64_t sequence, std::size_t added = 1, bool has_areas = false) {
    Send(app::StreamMessage::Edit{sequence, added, has_areas});
  }
  void Ping(std::uint64_t nonce) { Send(app::StreamMessage::Ping{nonce}); }
  void HalfClose();

  std::uint32_t measure_every = 1;  // when it opens
  double frame_seconds = 1e-3;      // when it opens, and of every frame

  // How the job ends: as it should, or not.
  void FinishJob(bool latest = true);
  void FailJob(Fault fault);

  void FinishWrite(bool ok = true);
  void End(Fault reason);
  void Cancel();
  // Answers whether the call is to be cancelled.
  bool Sweep();
  void Advance(std::chrono::milliseconds step) { clock.Advance(step); }

  // Opens, and reads the answer.
  void OpenAndAnswer(bool latest);

  std::size_t answers_kept = 0;  // by the policy and in `writing`

  // What is going on.
  bool reading = false;
  std::optional<app::StreamJob> job;
  std::optional<app::StreamAnswer> writing;
  std::optional<Status> finished;
  std::string broken;  // the first promise that the policy did not keep

  // The world around it.
  std::shared_ptr<const CompiledHandles> set = ThreeCorners();  // opens with it; edits change it
  bool no_room = false;                                         // lanes are full
  bool session_over = false;
  std::optional<Fault> too_busy;  // what admission says
  int touched = 0;
  // What admission was asked: "open" or "wake", with the share; and what it was told.
  std::vector<std::pair<std::string, double>> asked;
  std::vector<double> awake_shares;

  const Limits limits;
  runtime::FakeClock clock;
  app::StreamPolicy policy{limits,
                           clock,
                           {[this](double share) { return Admit("open", share); },
                            [this](double share) { return Admit("wake", share); },
                            [this](double share) { awake_shares.push_back(share); }}};

 private:
  void Pump();
  void Expect(bool kept, const char* promise) {
    if (!kept && broken.empty()) broken = promise;
  }
  std::unique_ptr<app::WireAnswer> NewAnswer();
  Status Admit(const char* what, double share) {
    asked.emplace_back(what, share);
    if (too_busy) return Fail(*too_busy);
    return {};
  }

  std::vector<std::unique_ptr<std::vector<double>>> positions_;
};

// Runs a policy through the events that the bytes stand for, as no client and server would be mad
// enough to bring about, and to its end. Answers the promise that was not kept, or nothing.
std::string DrivePolicy(const std::uint8_t* data, std::size_t size);

}  // namespace arap::testing
