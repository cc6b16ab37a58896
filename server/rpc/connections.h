// Connections: who is connected, how many there may be, and which of them may be let go.
//
// gRPC owns the sockets. What it does not say, when one is over and how much has come in on it, the
// kernel is asked for: a connection is over when its descriptor no longer is that socket.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "arap/base/result.h"
#include "core/base/mutex.h"
#include "server/rpc/probation.h"
#include "server/runtime/clock.h"
#include "server/runtime/token_bucket.h"

struct sockaddr_storage;

namespace arap::rpc {

struct ConnectionBounds {
  std::size_t most = 4'000;              // at once
  std::size_t most_per_address = 1'000;  // of one IPv4 address or one IPv6 network of 64 bits
  // New ones of an address: so many at once, and so many a second. Each costs gRPC more than a frame
  // costs us; the others wait, and nobody is sent away for it.
  std::size_t arrivals_at_once = 64;
  double arrivals_per_second = 250;
  // What a connection may do before a call on it was let in: live for so long, and send so much.
  std::chrono::milliseconds unknown_time = std::chrono::seconds(60);
  std::size_t unknown_bytes = 256u << 10u;
  // Calls that are not let in, of one connection: so many, and so many more a second. Who makes more
  // is cut, as is who sends too much, and the address is on probation: until so long after the last
  // such offence so many connections of it come in each second, and those that are not known may do
  // a sixteenth. 0 calls: neither calls nor bytes are counted, nobody is on probation, and new ones
  // come in as they come.
  std::size_t unknown_calls = 128;
  double unknown_calls_per_second = 16;
  std::chrono::milliseconds probation = std::chrono::seconds(30);
  double probation_connections_per_second = 10;
  // Calls of one connection that have begun and not ended. HTTP/2 bounds those that are open, but
  // not those that a client has reset and that nobody has cleared away yet. On a busy machine gRPC
  // holds ten to thirty times as many that have not begun, with 8 KB each: so fewer may be, when
  // memory is held that nobody accounts for.
  std::size_t most_calls = 2'048;
  std::size_t most_calls_under_pressure = 640;
  // Requests that have begun to come in and are not complete: how many, how many bytes of them all,
  // and how long each may take.
  std::size_t most_receiving = 1'024;
  std::size_t receiving_bytes = std::size_t{512} << 20u;
  std::chrono::milliseconds receiving_time = std::chrono::seconds(60);
  // After this much, and a tenth, streams are asked to move to a new connection; 0: never.
  std::chrono::milliseconds most_age{0};
};

// Thread-safe. Unix sockets are counted, and nothing else is known of theirs: the file system has
// said who may use them.
class Connections {
 public:
  using Told = std::function<void(Fault)>;

  // `clock` outlives it.
  Connections(const ConnectionBounds& bounds, const runtime::Clock& clock)
      : bounds_(bounds),
        clock_(clock),
        probation_(bounds.probation, bounds.probation_connections_per_second) {}

  // `told` hears how much is held of requests that come in, when that has changed by much: in the
  // thread that sweeps; it must not call back. Before the first connection.
  void OnReceiving(std::function<void(std::size_t bytes)> told) { on_receiving_ = std::move(told); }

  // `asked` says whether much more memory is in use than is accounted for. It is asked with a lock
  // held, and only of connections with many calls, at some of them. Before the first connection.
  void OnPressure(std::function<bool()> asked) { under_pressure_ = std::move(asked); }

  // kSoon: many of its address have just come, ask again in a moment. kLater: its address is on
  // probation, likewise. kGreedy: it is, and the connection has sent too much already.
  enum class Answer { kWelcome, kSoon, kLater, kGreedy, kFull, kAddressFull };
  // Whether the new connection may come in. Where there are too many, the oldest on which nobody
  // was let in yet makes room.
  Answer Admit(int descriptor, const sockaddr_storage& peer);

  // A call on the connection of this peer, as gRPC names it ("ipv4:10.0.0.1:5555"), was let in: what
  // was refused before is forgiven.
  void Known(std::string_view peer);

  // A call of this peer begins, which was let in or not; it ends when the answer goes. A connection
  // with more than most_calls (fewer under pressure) is cut, and one that makes too many that are not let in, unless one
  // that was is still open.
  std::shared_ptr<const void> Begin(std::string_view peer, bool let_in);

  // Ends what it began when it goes. An empty one is nothing. Move-only.
  class Entry {
   public:
    Entry() = default;
    Entry(Entry&& other) noexcept { *this = std::move(other); }
    Entry& operator=(Entry&& other) noexcept {
      std::swap(owner_, other.owner_);
      std::swap(id_, other.id_);
      return *this;
    }
    ~Entry() {
      if (owner_ != nullptr) owner_->Remove(id_, 0);
    }
    // The request is here, with so many bytes.
    void Received(std::size_t bytes) {
      if (owner_ != nullptr) std::exchange(owner_, nullptr)->Remove(id_, bytes);
    }

   private:
    friend class Connections;
    Entry(Connections* owner, std::uint64_t id) : owner_(owner), id_(id) {}
    Connections* owner_ = nullptr;
    std::uint64_t id_ = 0;
  };

  // A request begins to come in. `late` runs at most once, in the thread that sweeps, when it took
  // too long; let it hold what it touches. kOverloaded when too many do so.
  Result<Entry> Receive(std::string_view peer, Told late);
  // A call that lasts: `old` runs at most once, likewise, with kDraining, when the connection has
  // reached its age.
  Entry WatchAge(std::string_view peer, Told old);

  // Forgets connections that are over, cuts those that break the bounds, tells who is late or old.
  // To be called every Pause().
  void Sweep();
  // Short while requests come in, or somebody is connected who is not known.
  std::chrono::milliseconds Pause() const;

  std::size_t count() const;
  // How many were cut to make room or because they broke a bound.
  std::uint64_t cut() const;

 private:
  // That have begun and not ended.
  struct Calls {
    std::atomic<std::size_t> all = 0, let_in = 0;
  };
  struct Connection {
    int descriptor = -1;
    std::uint64_t cookie = 0;  // the kernel's name of the socket
    std::string address;       // what is counted by; empty: a unix socket
    runtime::Clock::Steady since;
    runtime::TokenBucket strange;   // for calls that are not let in
    std::size_t strange_calls = 0;  // since the last one that was
    bool known = false;
    bool slow = false;  // little of what it sends is taken from the network at a time
    std::shared_ptr<Calls> calls = std::make_shared<Calls>();
    // Of the requests that come in now: how many, the bytes of the socket when the first of them
    // began, and the bytes of those that are complete.
    std::size_t receiving = 0;
    std::uint64_t bytes_before = 0;
    std::uint64_t bytes_complete = 0;
    std::uint64_t bytes_seen = 0;  // of the socket when the last of them ended
  };
  using Table = std::map<std::string, Connection, std::less<>>;  // by peer
  struct Watched {
    std::string peer;
    runtime::Clock::Steady end;
    bool receiving = false;
    Told told;
  };

  // IPv4 addresses and IPv6 networks; empty: unix sockets.
  struct Address {
    std::size_t connections = 0;
    runtime::TokenBucket arrivals;
  };

  void Remove(std::uint64_t id, std::size_t bytes);
  void EndReceiving(const Watched& watched, std::size_t bytes)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  Table::iterator Forget(Table::iterator connection) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Ends the connection and forgets it.
  Table::iterator Cut(Table::iterator connection) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // The same of one whose stranger asked for too much.
  Table::iterator CutStranger(Table::iterator connection) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // By how much less a connection may do because of its address, which may be on probation only
  // since it came.
  std::size_t PartOf(const Connection& connection) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Whether a connection may have so many calls that have not ended.
  bool MayHave(std::size_t calls) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Whether one more call that is not let in may be made on it; it counts.
  bool MayCall(Connection& stranger) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Whether one that is unknown has not sent too much.
  bool MayStay(const Connection& connection) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Forgets those that are over and cuts strangers: not every time, since the kernel is asked for
  // each.
  void LookAround() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  std::chrono::milliseconds LookPause() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void ForgetClosed() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void ForgetAddresses() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Cuts the oldest unknown one, of the address unless it is empty: whether there was one.
  bool MakeRoom(const std::string& address) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Cuts what holds the most of requests that are not complete while these are too much.
  void CutGreedy() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void TellReceiving(std::size_t bytes) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool IsFull() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool IsFull(const std::string& address) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const ConnectionBounds bounds_;
  const runtime::Clock& clock_;
  std::function<void(std::size_t)> on_receiving_;
  std::function<bool()> under_pressure_;
  mutable Mutex mutex_;
  Table connections_ ABSL_GUARDED_BY(mutex_);
  std::map<std::string, Address> addresses_ ABSL_GUARDED_BY(mutex_);
  std::size_t strangers_ ABSL_GUARDED_BY(mutex_) = 0;  // connections that are not known
  Probation probation_ ABSL_GUARDED_BY(mutex_);
  runtime::Clock::Steady next_look_ ABSL_GUARDED_BY(mutex_);
  std::map<std::uint64_t, Watched> watched_ ABSL_GUARDED_BY(mutex_);
  std::size_t receiving_ ABSL_GUARDED_BY(mutex_) = 0;
  std::size_t told_receiving_ ABSL_GUARDED_BY(mutex_) = 0;  // bytes
  std::uint64_t next_id_ ABSL_GUARDED_BY(mutex_) = 1;
  std::uint64_t cut_ ABSL_GUARDED_BY(mutex_) = 0;
  std::chrono::steady_clock::time_point looked_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace arap::rpc
