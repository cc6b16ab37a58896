#include "server/host/acceptor.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <iterator>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "core/base/try.h"
#include "server/rpc/peer.h"

namespace arap::host {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

// Connections of one listener before the others have their turn.
constexpr int kTurn = 64;
constexpr int kLater = 20;  // milliseconds
// Connections that were cut are closed by gRPC a little later: so long their descriptors are waited
// for before anybody is sent away.
constexpr milliseconds kDescriptorsPatience{500};
// Connections that wait for being let in: in all, of one address, of one on probation, and how often
// it is asked for them.
constexpr std::size_t kMostWaiting = 4'000;
constexpr std::size_t kMostOfOne = 1'000;
constexpr std::size_t kMostOnProbation = 16;
constexpr milliseconds kAskAgain{20};

Descriptor Spare() { return Descriptor(open("/dev/null", O_RDONLY | O_CLOEXEC)); }

std::string Bytes(const sockaddr_storage& name, socklen_t size) {
  return {reinterpret_cast<const char*>(&name), std::min<std::size_t>(size, sizeof name)};
}

// The same name on the way back: an IPv4 address comes in on a socket of both families as an IPv6
// one, so that of names of hosts only the port is compared.
std::string NameOf(const sockaddr_storage& name, socklen_t size) {
  if (name.ss_family == AF_UNIX) return Bytes(name, size);
  const auto port = name.ss_family == AF_INET6
                        ? reinterpret_cast<const sockaddr_in6&>(name).sin6_port
                        : reinterpret_cast<const sockaddr_in&>(name).sin_port;
  return std::to_string(ntohs(port));
}

// Whether `events` happen to the descriptor before the end.
bool Await(int descriptor, short events, steady_clock::time_point end) {
  for (;;) {
    const auto left = std::chrono::ceil<milliseconds>(end - steady_clock::now()).count();
    if (left <= 0) return false;
    pollfd wait{descriptor, events, 0};
    const int ready = poll(&wait, 1, static_cast<int>(left));
    if (ready > 0) return true;
    if (ready < 0 && errno != EINTR) return false;
  }
}

// Whether the other end of a TCP connection is still there.
bool IsOpen(const Descriptor& connection) {
  tcp_info info{};
  socklen_t size = sizeof info;
  return getsockopt(connection.number(), IPPROTO_TCP, TCP_INFO, &info, &size) == 0 &&
         info.tcpi_state == TCP_ESTABLISHED;
}

// Where a client of this machine connects to for this listener.
sockaddr_storage Target(const Descriptor& listener, socklen_t& size) {
  sockaddr_storage name{};
  size = sizeof name;
  getsockname(listener.number(), reinterpret_cast<sockaddr*>(&name), &size);
  if (name.ss_family == AF_INET) {
    auto& four = reinterpret_cast<sockaddr_in&>(name);
    if (four.sin_addr.s_addr == htonl(INADDR_ANY)) four.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  } else if (name.ss_family == AF_INET6) {
    auto& six = reinterpret_cast<sockaddr_in6&>(name);
    // A socket of both families has 127.0.0.1 in any case.
    constexpr std::array<std::uint8_t, 16> kMapped{0, 0, 0,    0,    0,   0, 0, 0,
                                                   0, 0, 0xFF, 0xFF, 127, 0, 0, 1};
    int only = 0;
    socklen_t only_size = sizeof only;
    getsockopt(listener.number(), IPPROTO_IPV6, IPV6_V6ONLY, &only, &only_size);
    if (IN6_IS_ADDR_UNSPECIFIED(&six.sin6_addr)) {
      six.sin6_addr = in6addr_loopback;
      if (only == 0) std::copy(kMapped.begin(), kMapped.end(), std::begin(six.sin6_addr.s6_addr));
    }
  }
  return name;
}

}  // namespace

Acceptor::Acceptor(std::vector<Entrance> entrances, rpc::Connections& connections,
                   runtime::Metrics& metrics)
    : entrances_(std::move(entrances)),
      connections_(connections),
      metrics_(metrics),
      wake_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
      reserve_(Spare()),
      thread_([this] { Run(); }) {}

Acceptor::~Acceptor() { Stop(); }

void Acceptor::Stop() {
  if (!thread_.joinable()) return;
  stopped_ = true;
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = write(wake_.number(), &one, sizeof one);
  thread_.join();
  entrances_.clear();
}

void Acceptor::Run() {
  std::vector<pollfd> waits{{wake_.number(), POLLIN, 0}};
  std::vector<std::pair<const Entrance*, const Descriptor*>> listeners;
  for (const Entrance& entrance : entrances_) {
    for (const Descriptor& listener : entrance.listening.sockets()) {
      waits.push_back({listener.number(), POLLIN, 0});
      listeners.emplace_back(&entrance, &listener);
    }
  }
  auto swept = steady_clock::now();
  while (!stopped_) {
    const milliseconds pause = connections_.Pause();
    const milliseconds wait = waiting_.empty() ? pause : std::min(pause, kAskAgain);
    poll(waits.data(), waits.size(), static_cast<int>(wait.count()));
    AskForWaiting();
    for (std::size_t i = 0; i < listeners.size() && !stopped_; ++i) {
      if (waits[i + 1].revents != 0) AcceptAll(*listeners[i].first, *listeners[i].second);
    }
    if (steady_clock::now() - swept < pause) continue;
    connections_.Sweep();
    swept = steady_clock::now();
  }
}

int Acceptor::AcceptOne(const Descriptor& listener, sockaddr_storage& peer) {
  for (;;) {
    peer = {};
    socklen_t size = sizeof peer;
    const int accepted = accept4(listener.number(), reinterpret_cast<sockaddr*>(&peer), &size,
                                 SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (accepted >= 0) {
      short_since_.reset();
      if (!IsOurs(peer, size)) return accepted;
      close(accepted);
      continue;
    }
    switch (errno) {
      case EINTR:
      case ECONNABORTED:
      case EPROTO:
        break;
      case EAGAIN:
        return -1;
      default:
        NoDescriptor(listener);
        return -1;
    }
  }
}

void Acceptor::NoDescriptor(const Descriptor& listener) {
  if (waiting_count_ > 0) return DropOneWaiting();
  const auto now = steady_clock::now();
  if (!short_since_) short_since_ = now;
  now - *short_since_ < kDescriptorsPatience ? WaitALittle() : RefuseOne(listener);
}

void Acceptor::DropOneWaiting() {
  const auto longest =
      std::max_element(waiting_.begin(), waiting_.end(), [](const auto& a, const auto& b) {
        return a.second.arrivals.size() < b.second.arrivals.size();
      });
  longest->second.arrivals.pop_front();
  --waiting_count_;
  metrics_.Rejected("descriptors");
}

void Acceptor::RefuseOne(const Descriptor& listener) {
  metrics_.Rejected("descriptors");
  // Who waits at the door is sent away instead of waiting for ever.
  reserve_ = Descriptor();
  if (const Descriptor refused(accept4(listener.number(), nullptr, nullptr, SOCK_CLOEXEC));
      refused.number() < 0) {
    // Nothing helps, and the listener goes on being ready.
    WaitALittle();
  }
  reserve_ = Spare();
}

void Acceptor::WaitALittle() {
  pollfd wait{wake_.number(), POLLIN, 0};
  poll(&wait, 1, kLater);
}

void Acceptor::AcceptAll(const Entrance& entrance, const Descriptor& listener) {
  for (int i = 0; i < kTurn; ++i) {
    sockaddr_storage peer{};
    const int accepted = AcceptOne(listener, peer);
    if (accepted < 0) return;
    Arrival arrival{&entrance, Descriptor(accepted), peer};
    const auto before = waiting_.find(rpc::AddressOf(peer));
    // Nobody passes those who wait.
    before == waiting_.end() ? Receive(std::move(arrival))
                             : Wait(std::move(arrival), before->second);
  }
}

void Acceptor::Receive(Arrival arrival) {
  using Answer = rpc::Connections::Answer;
  const Answer answer = connections_.Admit(arrival.socket.number(), arrival.peer);
  switch (answer) {
    case Answer::kWelcome:
      return HandOver(arrival);
    case Answer::kSoon:
    case Answer::kLater: {
      Queue& queue = waiting_[rpc::AddressOf(arrival.peer)];
      queue.on_probation = answer == Answer::kLater;
      return Wait(std::move(arrival), queue);
    }
    case Answer::kGreedy:
      return metrics_.Rejected("address_on_probation");
    case Answer::kFull:
      return metrics_.Rejected("max_connections");
    case Answer::kAddressFull:
      return metrics_.Rejected("max_connections_per_address");
  }
}

void Acceptor::HandOver(Arrival& arrival) {
  const int yes = 1;
  if (arrival.peer.ss_family != AF_UNIX) {
    setsockopt(arrival.socket.number(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  }
  arrival.entrance->hand_over(arrival.socket.Release());
}

void Acceptor::Wait(Arrival arrival, Queue& queue) {
  if (waiting_count_ < kMostWaiting &&
      queue.arrivals.size() < (queue.on_probation ? kMostOnProbation : kMostOfOne)) {
    queue.arrivals.push_back(std::move(arrival));
    ++waiting_count_;
  } else {
    metrics_.Rejected(queue.on_probation ? "address_on_probation" : "max_connections_per_address");
  }
}

void Acceptor::AskForWaiting() {
  for (auto& [address, queue] : std::exchange(waiting_, {})) {
    std::deque<Arrival>& arrivals = queue.arrivals;
    waiting_count_ -= arrivals.size();
    while (!arrivals.empty() && !waiting_.contains(address)) {
      Arrival first = std::exchange(arrivals.front(), {});
      arrivals.pop_front();
      if (IsOpen(first.socket)) Receive(std::move(first));
    }
    // The first of them goes on waiting, so all the others do.
    for (Arrival& arrival : arrivals) Wait(std::move(arrival), waiting_[address]);
  }
}

bool Acceptor::IsOurs(const sockaddr_storage& peer, unsigned size) {
  const MutexLock lock(&mutex_);
  return dialled_.contains(NameOf(peer, size));
}

Status Acceptor::Dial(milliseconds patience) {
  const auto end = steady_clock::now() + patience;
  for (const Entrance& entrance : entrances_) {
    for (const Descriptor& listener : entrance.listening.sockets()) {
      CHECK_OK(DialOne(listener, entrance.listening.address(), end));
    }
  }
  return {};
}

Status Acceptor::DialOne(const Descriptor& listener, const std::string& address,
                         steady_clock::time_point end) {
  socklen_t size = 0;
  const sockaddr_storage target = Target(listener, size);
  const Descriptor dialling(
      socket(target.ss_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (dialling.number() < 0) {
    return Fail(FaultKind::kInternal, "There is no file descriptor left.");
  }
  // Bound before it connects, so that its name is known before it is let in: any free one.
  sockaddr_storage own{};
  own.ss_family = target.ss_family;
  const socklen_t own_size = target.ss_family == AF_UNIX    ? sizeof(sa_family_t)
                             : target.ss_family == AF_INET6 ? sizeof(sockaddr_in6)
                                                            : sizeof(sockaddr_in);
  socklen_t name_size = sizeof own;
  if (bind(dialling.number(), reinterpret_cast<const sockaddr*>(&own), own_size) != 0 ||
      getsockname(dialling.number(), reinterpret_cast<sockaddr*>(&own), &name_size) != 0) {
    return Fail(FaultKind::kInternal, "No socket can be bound to ask " + address + ".");
  }
  const std::string name = NameOf(own, name_size);
  {
    const MutexLock lock(&mutex_);
    dialled_.insert(name);
  }
  const int connected =
      connect(dialling.number(), reinterpret_cast<const sockaddr*>(&target), size);
  // Whoever lets it in closes it: there is an end to read.
  char byte = 0;
  const bool answered = (connected == 0 || errno == EINPROGRESS) &&
                        Await(dialling.number(), POLLIN, end) &&
                        recv(dialling.number(), &byte, 1, 0) == 0;
  const MutexLock lock(&mutex_);
  dialled_.erase(name);
  if (answered) return {};
  return Fail(FaultKind::kInternal, fmt::format("Nobody is let in on {}.", address));
}

}  // namespace arap::host
