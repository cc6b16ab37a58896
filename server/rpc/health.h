// grpc.health.v1: whether new calls should come here. It asks nobody who they are.
//
// In place of gRPC's own, which keeps as many watchers, and as much of their requests, as anybody
// cares to send.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include <grpc/health/v1/health.pb.h>

#include "arap/base/result.h"
#include "core/base/mutex.h"
#include "server/rpc/connections.h"
#include "server/rpc/services.h"

namespace arap::rpc {

// Thread-safe. Outlives the server that its service is registered with.
class Health {
 public:
  using State = grpc::health::v1::HealthCheckResponse::ServingStatus;

  // Answers for these services, and for "", the server as a whole. All serve at first.
  // `connections` outlives it.
  Health(const std::vector<std::string>& services, Connections& connections);
  ~Health();
  Health(const Health&) = delete;
  Health& operator=(const Health&) = delete;

  NamedService MakeService(const Backend& backend);

  // Of all services. Watchers are told.
  void Serving(bool serving);
  // Ends all watchers, with kDraining, and whoever comes from now on.
  void End();

  // SERVICE_UNKNOWN for another name.
  State StateOf(const std::string& service) const;

 private:
  class Reactor;
  Status Add(const std::shared_ptr<Reactor>& watcher);
  void Remove(const Reactor* watcher);
  std::vector<std::shared_ptr<Reactor>> Watchers() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const std::vector<std::string> services_;
  Connections& connections_;
  mutable Mutex mutex_;
  bool serving_ ABSL_GUARDED_BY(mutex_) = true;
  bool ended_ ABSL_GUARDED_BY(mutex_) = false;
  std::map<const Reactor*, std::weak_ptr<Reactor>> watchers_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace arap::rpc
