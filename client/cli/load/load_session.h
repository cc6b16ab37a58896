// The sessions of a load generator and the connections that they are reached over.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arap/base/result.h"
#include "arap/client/client.h"
#include "client/cli/load/scene.h"
#include "client/cli/load/schedule.h"
#include "client/src/channel.h"
#include "core/base/mutex.h"

namespace arap::cli {

// A connection that may be replaced while it is used. Thread-safe.
class LoadConnection {
 public:
  using Channel = client::internal::Channel;

  explicit LoadConnection(std::shared_ptr<Channel> channel) : channel_(std::move(channel)) {}

  // The channel of the moment, and its number.
  std::pair<std::shared_ptr<Channel>, std::uint64_t> Get() const;
  // The one with this number may be dead without saying so: the next are of another, one for all who
  // noticed.
  void Replace(std::uint64_t number);

 private:
  mutable Mutex mutex_;
  std::shared_ptr<Channel> channel_ ABSL_GUARDED_BY(mutex_);
  std::uint64_t number_ ABSL_GUARDED_BY(mutex_) = 0;
};

// The handle set that every session has.
inline constexpr const char* kLoadSet = "load";

struct LoadSession {
  std::string id;  // empty: it could not be opened
  LoadConnection* connection = nullptr;
  std::string mesh_id;
};

// Opens `count` sessions, each over the connection that `of` says, registers the mesh in each and compiles
// its handles, some at a time, with the library's calls, their checks and their repetitions. `told` hears
// of every fault, from any thread; with `stop` what is left is not tried. A session that failed has no
// id.
std::vector<LoadSession> OpenLoadSessions(std::size_t count,
                                          const std::function<LoadConnection&(std::size_t)>& of,
                                          const LoadScene& scene, const client::CallOptions& call,
                                          const std::function<void(const Fault&)>& told);
// Deletes them. A session that stays behind expires by itself, so faults are passed over.
void DeleteLoadSessions(const std::vector<LoadSession>& sessions, const client::CallOptions& call);

}  // namespace arap::cli
