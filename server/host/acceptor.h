// Acceptor: lets connections in and hands them to gRPC.
//
// gRPC 1.51 would listen itself, but knows no bound, and after one failed accept its listener is
// deaf for good (CVE-2023-4785). Here every failure is ours, and a listener that is deaf is told.
#pragma once

#include <atomic>
#include <chrono>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <sys/socket.h>

#include "arap/base/result.h"
#include "core/base/mutex.h"
#include "server/host/listen.h"
#include "server/rpc/connections.h"
#include "server/runtime/metrics.h"

namespace arap::host {

// Thread-safe but for Stop, which one thread calls.
class Acceptor {
 public:
  // One address, and what takes its connections: a non-blocking socket, which is then its own.
  struct Entrance {
    Listening listening;
    std::function<void(int descriptor)> hand_over;
  };

  // Accepts in a thread of its own, which also sweeps `connections`. Both outlive it.
  Acceptor(std::vector<Entrance> entrances, rpc::Connections& connections,
           runtime::Metrics& metrics);
  // Stops.
  ~Acceptor();
  Acceptor(const Acceptor&) = delete;
  Acceptor& operator=(const Acceptor&) = delete;

  // Closes the addresses. Connections that are in stay, and are swept no more. Harmless when
  // repeated.
  void Stop();

  // Connects to every address as a client does and waits until it was let in: kInternal with the
  // first address that does not do so within `patience`.
  Status Dial(std::chrono::milliseconds patience);

 private:
  void Run();
  void AcceptAll(const Entrance& entrance, const Descriptor& listener);
  // One connection of the listener, -1 when there is none.
  int AcceptOne(const Descriptor& listener, sockaddr_storage& peer);
  // When no connection can be had: sends away one that waits; when none does, waits a little, and when
  // that has not helped sends away one at the door.
  void NoDescriptor(const Descriptor& listener);
  // The oldest of the address that has the most.
  void DropOneWaiting();
  void RefuseOne(const Descriptor& listener);
  // Until it is to stop, at most.
  void WaitALittle();
  // A connection that is not in yet.
  struct Arrival {
    const Entrance* entrance = nullptr;
    Descriptor socket;
    sockaddr_storage peer{};
  };
  // Hands it over, keeps it waiting or sends it away.
  void Receive(Arrival arrival);
  void HandOver(Arrival& arrival);
  // Those of one address, in the order in which they came.
  struct Queue {
    bool on_probation = false;
    std::deque<Arrival> arrivals;
  };
  void Wait(Arrival arrival, Queue& queue);
  // Asks again for those that wait.
  void AskForWaiting();
  Status DialOne(const Descriptor& listener, const std::string& address,
                 std::chrono::steady_clock::time_point end);
  // Whether Dial made the connection, by the name of its other end.
  bool IsOurs(const sockaddr_storage& peer, unsigned size);

  std::vector<Entrance> entrances_;
  rpc::Connections& connections_;
  runtime::Metrics& metrics_;
  Descriptor wake_;     // readable when it is to stop
  Descriptor reserve_;  // given up to accept, and refuse, when there are no descriptors left
  // Since when there are none; of the thread that accepts.
  std::optional<std::chrono::steady_clock::time_point> short_since_;
  std::map<std::string, Queue> waiting_;  // by address; of the thread that accepts
  std::size_t waiting_count_ = 0;         // likewise
  Mutex mutex_;
  std::set<std::string> dialled_ ABSL_GUARDED_BY(mutex_);  // names of our own sockets
  std::atomic<bool> stopped_{false};
  std::thread thread_;
};

}  // namespace arap::host
