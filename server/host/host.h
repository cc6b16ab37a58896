// Host: a running server — its lanes, its services, its ports — in one object.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/app/engine.h"
#include "server/app/limits.h"
#include "server/host/access.h"
#include "server/runtime/clock.h"

namespace arap::host {

struct HostOptions {
  std::vector<std::string> listen = {"127.0.0.1:50051"};  // see listen.h
  app::Limits limits;
  app::Lanes lanes;
  AccessOptions access;
  // Unless said: when only this machine reaches the server.
  std::optional<bool> reflection;
  std::shared_ptr<const runtime::Clock> clock;  // null: the system's
  store::StoreOptions store;                    // memory unless told
};

class Host {
 public:
  // Serves when it returns. The ports are this process's alone: a taken port is a fault. Faults:
  // kInvalidOption and kAlreadyExists with the address, and those of Access::Open.
  static Result<std::unique_ptr<Host>> Start(HostOptions options);

  // Stops without grace.
  ~Host();
  Host(const Host&) = delete;
  Host& operator=(const Host&) = delete;

  // The listen addresses in the order of the options, with the ports that were bound.
  const std::vector<std::string>& addresses() const { return addresses_; }

  // What the services work on.
  app::Engine& engine();
  // Who may use them.
  Access& access();

  // Says NOT_SERVING, ends streams and tracks with DRAINING after the frame in work, refuses new
  // calls, waits at most `grace` for the running ones, cancels the rest. Returns when nothing runs
  // any more. Harmless when repeated.
  void Stop(std::chrono::milliseconds grace);

 private:
  class Impl;
  Host(std::unique_ptr<Impl> impl, std::vector<std::string> addresses);

  std::unique_ptr<Impl> impl_;
  std::vector<std::string> addresses_;
};

}  // namespace arap::host
