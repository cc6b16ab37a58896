#include "server/rpc/connections.h"

#include <algorithm>
#include <vector>

#include "server/budget/faults.h"
#include "server/rpc/peer.h"

namespace arap::rpc {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kCalm{1'000};
constexpr milliseconds kBusy{20};
constexpr milliseconds kWatchful{50};
constexpr std::size_t kLooksPerMillisecond = 10;
constexpr std::size_t kReceivingStep = 4u << 20u;
constexpr std::size_t kAskPressureEvery = 64;

// What a stranger of an address on probation may do, as a part of what others may.
constexpr std::size_t kProbationPart = 16;
// What may wait in the kernel for being read, of such a stranger and of one who is known then.
constexpr int kSlowBuffer = 4 << 10;
constexpr int kQuickBuffer = 1 << 20;

// What HTTP/2 lets a client send of a request before the server says more.
constexpr std::uint64_t kWindow = 65'535;

Fault TooOld() {
  return Fault(FaultKind::kDraining,
               "This connection has reached its age; open again on a new one.")
      .Detail("resume", "open_again");
}

}  // namespace

Connections::Answer Connections::Admit(int descriptor, const sockaddr_storage& peer) {
  const MutexLock lock(&mutex_);
  const auto now = clock_.SteadyNow();
  const std::string address = AddressOf(peer);
  const bool slow = !address.empty() && probation_.IsOn(address, now);
  if (slow) {
    SetBuffer(descriptor, kSlowBuffer);
    if (BytesOf(descriptor) > bounds_.unknown_bytes / kProbationPart) return Answer::kGreedy;
    if (!probation_.LetIn(address, now)) return Answer::kLater;
  }
  const auto at_once = static_cast<double>(bounds_.arrivals_at_once);
  const double rate = bounds_.unknown_calls > 0 ? bounds_.arrivals_per_second : 0;
  const runtime::TokenBucket arrivals(rate, at_once, now);
  Address& counted = addresses_.try_emplace(address, Address{0, arrivals}).first->second;
  if (!address.empty() && !counted.arrivals.Take(now)) return Answer::kSoon;
  const auto calls = static_cast<double>(bounds_.unknown_calls);
  Connection connection{.descriptor = descriptor,
                        .cookie = CookieOf(descriptor),
                        .address = address,
                        .since = now,
                        .strange = {bounds_.unknown_calls_per_second, calls, now},
                        .known = address.empty(),
                        .slow = slow};
  if (IsFull() || IsFull(connection.address)) ForgetClosed();
  if (IsFull(connection.address) && !MakeRoom(connection.address)) return Answer::kAddressFull;
  if (IsFull() && !MakeRoom({})) return Answer::kFull;
  // Peers of unix sockets have no names.
  const std::string name =
      connection.address.empty() ? "unix:" + std::to_string(connection.cookie) : PeerName(peer);
  if (const auto old = connections_.find(name); old != connections_.end()) Forget(old);
  ++counted.connections;
  if (!connection.known) ++strangers_;
  connections_.emplace(name, std::move(connection));
  return Answer::kWelcome;
}

void Connections::Known(std::string_view peer) {
  const MutexLock lock(&mutex_);
  const auto found = connections_.find(peer);
  if (found == connections_.end()) return;
  Connection& connection = found->second;
  connection.strange.Fill();
  connection.strange_calls = 0;
  if (!std::exchange(connection.known, true)) --strangers_;
  if (std::exchange(connection.slow, false)) {
    WithSocket(connection.descriptor, connection.cookie,
               [](int socket) { SetBuffer(socket, kQuickBuffer); });
  }
}

std::shared_ptr<const void> Connections::Begin(std::string_view peer, bool let_in) {
  const MutexLock lock(&mutex_);
  const auto found = connections_.find(peer);
  if (found == connections_.end()) return nullptr;
  Connection& connection = found->second;
  const std::shared_ptr<Calls> calls = connection.calls;
  if (let_in) ++calls->let_in;
  const bool counts = !let_in && bounds_.unknown_calls > 0;
  const bool within = !counts || MayCall(connection);
  if (!MayHave(++calls->all)) {
    connection.known ? Cut(found) : CutStranger(found);
  } else if (calls->let_in == 0 && (!within || !MayStay(connection))) {
    CutStranger(found);
  }
  return {calls.get(), [calls, let_in](const void*) {
            if (let_in) --calls->let_in;
            --calls->all;
          }};
}

bool Connections::MayHave(std::size_t calls) const {
  if (calls > bounds_.most_calls) return false;
  const std::size_t allowed = bounds_.most_calls_under_pressure;
  // Asking may take a while, so only some calls do.
  if (calls <= allowed || (calls - allowed - 1) % kAskPressureEvery != 0) return true;
  return !under_pressure_ || !under_pressure_();
}

std::size_t Connections::PartOf(const Connection& connection) const {
  const bool less = !connection.known && probation_.IsOn(connection.address, clock_.SteadyNow());
  return less ? kProbationPart : 1;
}

bool Connections::MayCall(Connection& stranger) const {
  return stranger.strange.Take(clock_.SteadyNow()) &&
         (++stranger.strange_calls <= bounds_.unknown_calls / kProbationPart ||
          PartOf(stranger) == 1);
}

bool Connections::MayStay(const Connection& connection) const {
  return connection.known || bounds_.unknown_calls == 0 ||
         BytesOf(connection.descriptor) <= bounds_.unknown_bytes / PartOf(connection);
}

Result<Connections::Entry> Connections::Receive(std::string_view peer, Told late) {
  const MutexLock lock(&mutex_);
  if (receiving_ >= bounds_.most_receiving) return Fail(app::Overloaded());
  ++receiving_;
  if (const auto found = connections_.find(peer); found != connections_.end()) {
    Connection& connection = found->second;
    if (connection.receiving++ == 0) {
      // What came right before the call was known here may be of its request.
      const std::uint64_t now = BytesOf(connection.descriptor);
      connection.bytes_before = std::max(connection.bytes_seen, now - std::min(now, kWindow));
      connection.bytes_complete = 0;
    }
  }
  const auto end = clock_.SteadyNow() + bounds_.receiving_time;
  watched_.emplace(next_id_, Watched{std::string(peer), end, true, std::move(late)});
  return Entry(this, next_id_++);
}

Connections::Entry Connections::WatchAge(std::string_view peer, Told old) {
  if (bounds_.most_age.count() <= 0) return {};
  const MutexLock lock(&mutex_);
  const auto found = connections_.find(peer);
  if (found == connections_.end()) return {};
  // By then gRPC, which varies the age by a tenth, has told the client to take another connection.
  const auto end = found->second.since + bounds_.most_age * 11 / 10 + kCalm;
  watched_.emplace(next_id_, Watched{std::string(peer), end, false, std::move(old)});
  return Entry(this, next_id_++);
}

void Connections::Remove(std::uint64_t id, std::size_t bytes) {
  const MutexLock lock(&mutex_);
  const auto found = watched_.find(id);
  if (found == watched_.end()) return;
  EndReceiving(found->second, bytes);
  watched_.erase(found);
}

void Connections::EndReceiving(const Watched& watched, std::size_t bytes) {
  if (!watched.receiving) return;
  --receiving_;
  const auto found = connections_.find(watched.peer);
  if (found == connections_.end() || found->second.receiving == 0) return;
  --found->second.receiving;
  found->second.bytes_complete += bytes;
  if (found->second.receiving == 0) {
    found->second.bytes_seen = BytesOf(found->second.descriptor);
  }
}

Connections::Table::iterator Connections::Forget(Table::iterator connection) {
  --addresses_.find(connection->second.address)->second.connections;
  if (!connection->second.known) --strangers_;
  return connections_.erase(connection);
}

Connections::Table::iterator Connections::Cut(Table::iterator connection) {
  WithSocket(connection->second.descriptor, connection->second.cookie, ShutDown);
  ++cut_;
  return Forget(connection);
}

Connections::Table::iterator Connections::CutStranger(Table::iterator connection) {
  if (!connection->second.address.empty()) {
    probation_.Offended(connection->second.address, clock_.SteadyNow());
  }
  return Cut(connection);
}

void Connections::ForgetClosed() {
  // Asking for each costs the kernel's time, which is not to be had a hundred times a second.
  const auto now = std::chrono::steady_clock::now();
  if (now - looked_ < kWatchful) return;
  looked_ = now;
  for (auto at = connections_.begin(); at != connections_.end();) {
    const bool open = CookieOf(at->second.descriptor) == at->second.cookie;
    at = open ? std::next(at) : Forget(at);
  }
}

void Connections::ForgetAddresses() {
  std::erase_if(addresses_, [now = clock_.SteadyNow()](const auto& entry) {
    return entry.second.connections == 0 && entry.second.arrivals.IsFull(now);
  });
}

bool Connections::MakeRoom(const std::string& address) {
  auto oldest = connections_.end();
  for (auto at = connections_.begin(); at != connections_.end(); ++at) {
    if (at->second.known || (!address.empty() && at->second.address != address)) continue;
    if (oldest == connections_.end() || at->second.since < oldest->second.since) oldest = at;
  }
  if (oldest == connections_.end()) return false;
  Cut(oldest);
  return true;
}

bool Connections::IsFull() const { return connections_.size() >= bounds_.most; }

bool Connections::IsFull(const std::string& address) const {
  if (address.empty()) return false;
  const auto found = addresses_.find(address);
  return found != addresses_.end() && found->second.connections >= bounds_.most_per_address;
}

void Connections::CutGreedy() {
  struct Holder {
    std::uint64_t bytes;
    Table::iterator connection;
  };
  std::vector<Holder> holders;
  std::uint64_t all = 0;
  for (auto at = connections_.begin(); at != connections_.end(); ++at) {
    const Connection& connection = at->second;
    if (connection.receiving == 0) continue;
    const std::uint64_t before = connection.bytes_before + connection.bytes_complete;
    const std::uint64_t now = BytesOf(connection.descriptor);
    holders.push_back({now > before ? now - before : 0, at});
    all += holders.back().bytes;
  }
  std::sort(holders.begin(), holders.end(),
            [](const Holder& a, const Holder& b) { return a.bytes > b.bytes; });
  for (const Holder& holder : holders) {
    if (all <= bounds_.receiving_bytes) break;
    all -= holder.bytes;
    Cut(holder.connection);
  }
  TellReceiving(all);
}

void Connections::TellReceiving(std::size_t bytes) {
  // In whole steps, so that small requests change nothing.
  const std::size_t whole = bytes / kReceivingStep * kReceivingStep;
  if (whole == std::exchange(told_receiving_, whole) || !on_receiving_) return;
  on_receiving_(whole);
}

void Connections::LookAround() {
  const auto now = clock_.SteadyNow();
  if (now < next_look_) return;
  next_look_ = now + LookPause();
  ForgetClosed();
  ForgetAddresses();
  if (strangers_ == 0) return;
  for (auto at = connections_.begin(); at != connections_.end();) {
    const Connection& connection = at->second;
    const bool silent = !connection.known && now - connection.since > bounds_.unknown_time;
    at = silent ? Cut(at) : MayStay(connection) ? std::next(at) : CutStranger(at);
  }
}

milliseconds Connections::LookPause() const {
  const milliseconds all(connections_.size() / kLooksPerMillisecond);
  return std::clamp(all, kWatchful, kCalm);
}

void Connections::Sweep() {
  std::vector<std::pair<Told, bool>> due;
  {
    const MutexLock lock(&mutex_);
    const auto now = clock_.SteadyNow();
    LookAround();
    CutGreedy();
    for (auto at = watched_.begin(); at != watched_.end();) {
      if (at->second.end > now) {
        ++at;
        continue;
      }
      due.emplace_back(std::move(at->second.told), at->second.receiving);
      EndReceiving(at->second, 0);
      at = watched_.erase(at);
    }
  }
  for (const auto& [told, receiving] : due) {
    told(receiving ? Fault(FaultKind::kDeadlineExceeded, "The request took too long to arrive.")
                   : TooOld());
  }
}

milliseconds Connections::Pause() const {
  const MutexLock lock(&mutex_);
  if (receiving_ > 0) return kBusy;
  return strangers_ > 0 ? LookPause() : kCalm;
}

std::size_t Connections::count() const {
  const MutexLock lock(&mutex_);
  return connections_.size();
}

std::uint64_t Connections::cut() const {
  const MutexLock lock(&mutex_);
  return cut_;
}

}  // namespace arap::rpc
