// A private arapd for the length of a command.
#pragma once

#include <string>

#include <sys/types.h>

#include "arap/base/result.h"

namespace arap::cli {

// Runs arapd (the one beside our own executable, else the one in PATH) on a unix socket in a fresh
// directory. The destructor stops it and removes the directory; it dies with us too. Start it
// before gRPC is used: it forks. Move-only, for one thread.
class SpawnedServer {
 public:
  // Waits until the server listens. Its standard error is ours.
  static Result<SpawnedServer> Start();

  SpawnedServer(SpawnedServer&& other) noexcept;
  SpawnedServer& operator=(SpawnedServer&& other) noexcept;
  ~SpawnedServer();

  const std::string& address() const { return address_; }

 private:
  SpawnedServer() = default;
  Status Launch();
  Status AwaitListening();
  void Stop();

  std::string directory_;  // empty: nothing to remove
  std::string address_;
  pid_t pid_ = -1;   // -1: nothing to stop
  int output_ = -1;  // reading end of the server's standard output
};

}  // namespace arap::cli
