// Host: a running server — its lanes, its services, its ports — in one object.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <sys/types.h>

#include "arap/base/result.h"
#include "arap/model/limits.h"
#include "core/base/mutex.h"
#include "server/engine.h"
#include "server/host/acceptor.h"
#include "server/host/admin_http.h"
#include "server/host/credentials.h"
#include "server/host/readiness.h"
#include "server/rpc/connections.h"
#include "server/rpc/health.h"
#include "server/rpc/services.h"
#include "server/runtime/clock.h"
#include "server/runtime/ticker.h"

namespace grpc {
class CallbackGenericService;
class Server;
}  // namespace grpc

namespace arap::host {

struct HostOptions {
  std::vector<std::string> listen = {"127.0.0.1:50051"};  // see listen.h
  mode_t socket_mode = 0600;                              // of unix sockets
  rpc::ConnectionBounds connections;
  Limits limits;
  app::Lanes lanes;
  CredentialOptions credentials;
  // Unless said: when only this machine reaches the server.
  std::optional<bool> reflection;
  bool echo = false;  // EchoService, for measurements
  // After this much silence a client is asked for a sign of life, and it is cut off when it gives
  // none for so long: a peer that is half open must not keep what it holds.
  std::chrono::milliseconds keepalive = std::chrono::seconds(60);
  std::chrono::milliseconds keepalive_timeout = std::chrono::seconds(20);
  std::string admin;  // host:port of the admin page (admin_http.h); empty: none
  // How long a lane or the store may stand still before the server is not ready.
  std::chrono::milliseconds stuck_after = std::chrono::seconds(10);
  // How often sessions expire and what is idle is evicted; 0: never by itself.
  std::chrono::milliseconds sweep = std::chrono::seconds(1);
  std::shared_ptr<const runtime::Clock> clock;  // null: the system's
  store::StoreOptions store;                    // memory unless told
  // Runs once, in a thread of the host, when nobody has been let in for stuck_after: nothing but a
  // new process helps. May be empty.
  std::function<void()> on_deaf;
};

class Host {
 public:
  // Serves when it returns. The ports are this process's alone: a taken port is a fault. Faults:
  // kInvalidOption and kAlreadyExists with the address, and those of Credentials::Open.
  static Result<std::unique_ptr<Host>> Start(HostOptions options);

  // Stops without grace.
  ~Host();
  Host(const Host&) = delete;
  Host& operator=(const Host&) = delete;

  // The listen addresses in the order of the options, with the ports that were bound.
  const std::vector<std::string>& addresses() const { return addresses_; }

  // Of the admin page, with the port that was bound; empty when there is none.
  std::string admin_address() const { return admin_ ? admin_->address() : std::string(); }

  // What the services work on.
  app::Engine& engine() { return engine_; }
  // Who may use them.
  Credentials& credentials() { return *credentials_; }
  // What /readyz answers.
  const Readiness& readiness() const { return readiness_; }

  // Asks the store and the lanes, and tells grpc.health. Happens by itself every second.
  void RefreshHealth();

  // Not ready and NOT_SERVING from now on, while everything goes on working: load balancers look
  // for another server before this one refuses anything. Harmless when repeated.
  void AnnounceStop();

  // Announces it, ends streams and tracks with DRAINING after the frame in work, refuses new calls, waits
  // at most `grace` for the running ones, cancels the rest. Returns when nothing runs any more. The
  // admin page is served until then. Harmless when repeated.
  void Stop(std::chrono::milliseconds grace);

 private:
  Host(const HostOptions& options, std::shared_ptr<const runtime::Clock> clock,
       std::unique_ptr<Credentials> credentials, store::Stores stores);

  Status Serve(const HostOptions& options);
  // Says when it begins to fail and when it works again, not every second.
  void Sweep();
  // Knocks at our own doors.
  void Dial();
  // Whether much more memory is in use than is accounted for. Thread-safe; up to a millisecond.
  bool UnderPressure() const;
  // Gives back what a flood or an eviction has freed: by itself the allocator keeps the most that
  // each of its arenas ever held.
  void TrimMemory();
  // Each when it is seen first, and again when it has gone.
  void LogWeaknesses() ABSL_EXCLUSIVE_LOCKS_REQUIRED(health_mutex_);
  std::vector<std::string> ServiceNames() const;

  // Destroyed from the bottom up: the server before its services before what they work on.
  const std::shared_ptr<const runtime::Clock> clock_;
  const std::unique_ptr<Credentials> credentials_;
  app::Engine engine_;
  Readiness readiness_;
  rpc::Connections connections_;
  app::DerivedCache::Reservation half_requests_;  // that come in; of the thread that accepts
  rpc::Identity identity_;
  std::vector<rpc::NamedService> services_;
  rpc::Health health_;
  const std::unique_ptr<grpc::CallbackGenericService> unknown_methods_;
  std::vector<std::string> addresses_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<Acceptor> acceptor_;
  std::unique_ptr<AdminHttp> admin_;
  Mutex health_mutex_;  // what is said to grpc.health follows the order of what is found
  Verdict::State said_ ABSL_GUARDED_BY(health_mutex_) = Verdict::State::kReady;
  std::set<std::string> weak_ ABSL_GUARDED_BY(health_mutex_);  // reasons that were logged
  std::unique_ptr<runtime::Ticker> health_ticker_;
  std::function<void()> on_deaf_;  // of the thread that dials
  std::unique_ptr<runtime::Ticker> dial_ticker_;
  // Of the thread that sweeps.
  std::size_t sweeps_ = 0;
  double trimmed_to_ = 0;  // resident bytes after memory was given back
  bool sweep_failed_ = false;
  bool sweeping_ = false;
  std::unique_ptr<runtime::Ticker> sweep_ticker_;
};

}  // namespace arap::host
