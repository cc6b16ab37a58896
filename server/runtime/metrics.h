// Metrics: what the server counts and measures, for Prometheus to read.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/runtime/metric_names.h"

namespace arap::runtime {

// Where computing time goes.
enum class Phase {
  kRegister,         // checks and factors of a mesh
  kCompile,          // a handle set from nothing
  kEdit,             // handles added to and removed from a set
  kFrame,            // one update of a stream, one Deform
  kTrack,            // one frame of a track
  kFlatten,          // a flattening as a whole, and its parts in the processor time of its thread:
  kFlattenTopology,  // checks, cuts and charts
  kFlattenOrder,     // fill-reducing orders
  kFlattenFactor,    // factorisations
  kFlattenSolve,     // all the rest
  kRebuild,          // a mesh or handle set made again from what is stored
};
inline constexpr std::size_t kPhases = 11;

// The label value of a phase: "register", "flatten_order".
const char* PhaseName(Phase phase);

// Thread-safe; one per server. A call costs well below a microsecond. Names and kinds come from the
// program and never from a request, so that there are few of them; the names of the metrics are in
// metric_names.h.
class Metrics {
 public:
  // A value that is read whenever the metrics are.
  enum class Kind { kGauge, kCounter };
  using Labels = std::vector<std::pair<std::string, std::string>>;

  Metrics();
  ~Metrics();
  Metrics(const Metrics&) = delete;
  Metrics& operator=(const Metrics&) = delete;

  // An RPC has ended: Rpc("Deform", "OK", 0.001).
  void Rpc(std::string_view method, std::string_view code, double seconds);
  // A call that lasted, a stream or a track, has ended.
  void Stream(std::string_view method, std::string_view code, double seconds);
  // A job waited for a worker of `lane` ("interactive", "jobs").
  void Queue(std::string_view lane, double seconds);
  // Work was done; queueing is not part of it.
  void Phase(runtime::Phase phase, double seconds);
  // The store answered: Store("put", 0.002, true).
  void Store(std::string_view operation, double seconds, bool ok);

  // Serves the counts of a cache, or of a quota, from now on, also while they are 0.
  void ServeCache(std::string_view cache);
  void ServeQuota(std::string_view quota);

  // A cache ("meshes", "surfaces", …) had what was asked for, had not, has let something go.
  void CacheHit(std::string_view cache);
  void CacheMiss(std::string_view cache);
  void Evicted(std::string_view cache, std::size_t bytes);

  // Updates of streams that newer ones replaced before they started.
  void Coalesced(std::size_t updates);
  // A request was refused because of the quota of this name ("max_sessions", "queue").
  void Rejected(std::string_view quota);

  // Serves `read()` under the name and the labels whenever the metrics are read. The same name may
  // be watched with other labels; help and kind are then those of the first. `read` is called by
  // any thread that reads the metrics, must not call back into this object, and what it uses
  // outlives the last Text().
  void Watch(const MetricInfo& info, Kind kind, const Labels& labels, std::function<double()> read);

  // Everything in the text format of Prometheus, version 0.0.4.
  std::string Text() const;

 private:
  struct Impl;
  const std::unique_ptr<Impl> impl_;
};

}  // namespace arap::runtime
