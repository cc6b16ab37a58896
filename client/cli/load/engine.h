// LoadEngine: sessions, streams and threads of a load generator, and the stretches of time in which
// they send.
//
// Threads: two that pace, one that verifies, eight while sessions are opened and deleted, and those of
// gRPC, whatever the number of streams. Memory of a stream besides its share of the scene: some 30 kB,
// most of it gRPC's, and the largest shape that it has got, twice.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <vector>

#include "arap/client/client.h"
#include "client/cli/load/live_stream.h"
#include "client/cli/load/load_session.h"
#include "client/cli/load/pacer.h"
#include "client/cli/load/side_calls.h"
#include "client/cli/load/verifier.h"

namespace arap::cli {

struct EngineOptions {
  std::size_t sessions = 1, streams = 1;
  client::ShapeOptions shape;
  client::Delivery delivery = client::Delivery::kEvery;
  Mix mix;
  std::uint64_t seed = 0;
  double verify = 0;
  std::chrono::milliseconds resume_within{0};
  std::chrono::milliseconds silence = std::chrono::seconds(30);
  // How long answers are waited for when nothing is sent any more.
  std::chrono::milliseconds patience = std::chrono::seconds(10);
};

// A second of a phase has gone by: how many seconds since its beginning, and what happened meanwhile.
// False ends the phase.
using OnSecond = std::function<bool(double since_begin, const Glance& glance)>;

// How a phase went.
struct PhaseEnd {
  Moment ended{0};               // when everything was answered, or was not waited for any more
  double own_nanos_per_message;  // processor time of this process
};

// For one thread, but for `stop`.
class LoadEngine {
 public:
  // The n-th connection has the token n modulo `tokens`. The scene and the reference, where there is one,
  // have to outlive it.
  LoadEngine(const EngineOptions& options, const LoadScene& scene,
             std::vector<std::unique_ptr<LoadConnection>> connections, std::size_t tokens,
             std::stop_token stop);
  ~LoadEngine();

  // Answers are verified with this from now on.
  Status VerifyWith(const client::Client& reference);
  // Opens the sessions, and counts those that do not open.
  void OpenSessions(Tally& tally);
  // Opens the streams; what does not open is counted in the tallies of `phase`. Where each stream sends
  // from its opening on, it does so in this phase.
  void OpenStreams(const std::shared_ptr<LoadPhase>& phase);
  // Sends as `phase` says, as long as it says, until nothing more is to be sent, `on_second` says no or
  // `stop` is asked to; then waits for answers.
  PhaseEnd Run(const std::shared_ptr<LoadPhase>& phase, const OnSecond& on_second);
  // Ends streams and sessions.
  void Close();

  // Tallies for a phase: enough that threads seldom wait for each other.
  static std::vector<std::unique_ptr<Tally>> MakeTallies(
      Moment from, const std::shared_ptr<const RateProfile>& steps = nullptr);

 private:
  // Sessions are dealt round to the tokens, and then to the connections of their token; the streams of a
  // session take one connection after the other.
  LoadConnection& ConnectionOf(std::size_t session, std::size_t turn) const;
  std::uint64_t Messages() const;
  // Looks after the streams until the time is up, they are done or it shall stop; every second
  // `on_second` is asked. False when it shall stop.
  bool Watch(const LoadPhase& phase, Moment until, const OnSecond& on_second);

  const EngineOptions options_;
  const LoadScene& scene_;
  const std::vector<std::unique_ptr<LoadConnection>> connections_;
  const std::size_t tokens_;
  const std::stop_token stop_;
  std::unique_ptr<Verifier> verifier_;
  Gate gate_;
  Bell bell_;
  SideCalls side_calls_;
  StreamKind kind_;
  std::vector<LoadSession> sessions_;
  std::vector<std::unique_ptr<LiveStream>> streams_;
  std::unique_ptr<Pacer> pacer_;
  Moment looked_{0};
  std::size_t seconds_ = 0;  // of the phase that were told
};

}  // namespace arap::cli
