#include "tests/system/cluster/visitors.h"

#include <deque>

namespace arap::cluster {
namespace {

// Kept by each; older ones are deleted.
constexpr std::size_t kKeptSessions = 40;

}  // namespace

Visitors::Visitors(const std::string& address, const Puppet& puppet, std::size_t count)
    : address_(address), puppet_(puppet) {
  for (std::size_t i = 0; i < count; ++i) Join([this, i] { Visit(i); });
}

void Visitors::Visit(std::size_t number) {
  const client::Client client = client::Client::Connect(address_);
  std::deque<client::Session> kept;
  for (std::size_t turn = 0; !StopWithin(std::chrono::milliseconds(50)); ++turn) {
    client::SessionOptions named;
    named.id = "visit-" + std::to_string(number) + "-" + std::to_string(turn);
    const auto session = client.CreateSession(named, call_);
    if (!Answered("CreateSession", session) ||
        !Answered("RegisterMesh", session->RegisterMesh(puppet_.mesh, {}, "m", call_)) ||
        !Answered("CompileHandles", session->CompileHandles("h", "m", puppet_.handles, call_))) {
      continue;
    }
    ++acknowledged_;
    Deform(*session, turn);
    kept.push_back(*session);
    Deform(kept[turn % kept.size()], turn + 1);
    if (kept.size() <= kKeptSessions) continue;
    (void)Answered("DeleteSession", kept.front().Delete(call_));
    kept.pop_front();
  }
  for (const client::Session& session : kept) {
    const auto found = session.GetHandleSet("h", call_);
    if (!found && found.error().kind == FaultKind::kNotFound) ++lost_;
    if (Answered("GetHandleSet", found)) Deform(session, 3);
  }
}

void Visitors::Deform(const client::Session& session, std::size_t turn) {
  const Pose& pose = puppet_.poses[turn % puppet_.poses.size()];
  const std::vector<client::HandleTarget> targets{{"l", {pose.places[0]}}, {"r", {pose.places[1]}}};
  const auto shape = session.Deform("h", targets, {.float64 = true}, {}, call_);
  if (Answered("Deform", shape) && shape->positions != pose.shape) Complain("a wrong shape");
}

}  // namespace arap::cluster
