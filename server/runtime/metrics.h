// Metrics: what the server counts and measures, under which names, for Prometheus to read.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace arap::runtime {

struct MetricInfo {
  const char* name;
  const char* help;
};

// The names of all metrics and what they count. docs/operations.md explains them to operators.
namespace metric {

// Calls.
inline constexpr MetricInfo kRpcs{"arapd_rpcs_total",
                                  "RPCs that have ended, by method and status code."};
inline constexpr MetricInfo kRpcSeconds{
    "arapd_rpc_seconds", "From a request's arrival to the end of its call, by method."};
inline constexpr MetricInfo kStreamSeconds{"arapd_stream_seconds",
                                           "How long streams and tracks lived, by method."};
inline constexpr MetricInfo kRejected{"arapd_rejected_total",
                                      "Requests that a quota refused, by its name."};
inline constexpr MetricInfo kCoalesced{"arapd_coalesced_frames_total",
                                       "Updates of streams that newer ones replaced."};
inline constexpr MetricInfo kConnections{"arapd_connections", "Open connections."};
inline constexpr MetricInfo kConnectionsCut{
    "arapd_connections_cut_total",
    "Connections that made room for others or broke the bounds of what comes in."};
inline constexpr MetricInfo kOpenStreams{"arapd_open_streams", "Open streams and running tracks."};
inline constexpr MetricInfo kSessions{"arapd_sessions", "Sessions in memory."};

// Work, by lane or phase.
inline constexpr MetricInfo kPhaseSeconds{"arapd_phase_seconds",
                                          "How long the work took, without queueing."};
inline constexpr MetricInfo kQueueSeconds{"arapd_queue_seconds",
                                          "How long jobs waited for a worker."};
inline constexpr MetricInfo kQueueLength{"arapd_queue_length", "Jobs that wait for a worker."};
inline constexpr MetricInfo kJobsRunning{"arapd_jobs_running", "Jobs that run."};
inline constexpr MetricInfo kJobs{"arapd_jobs_total", "Jobs that have ended."};
inline constexpr MetricInfo kTakenAlong{
    "arapd_taken_along_total", "Frames that were computed together with another stream's."};
inline constexpr MetricInfo kGaveWay{"arapd_gave_way_total", "How often jobs waited for frames."};
inline constexpr MetricInfo kHelpedParts{
    "arapd_helped_parts_total", "Parts of another lane's long frames that idle threads took."};
inline constexpr MetricInfo kBusySeconds{"arapd_busy_seconds_total",
                                         "Time that workers spent on jobs, of all threads."};
inline constexpr MetricInfo kOldestJobSeconds{"arapd_oldest_job_seconds",
                                              "How long the longest running job runs."};
inline constexpr MetricInfo kWorkers{"arapd_workers", "Threads."};

// The store, by operation.
inline constexpr MetricInfo kStoreSeconds{"arapd_store_seconds",
                                          "How long the store took to answer."};
inline constexpr MetricInfo kStoreFailures{"arapd_store_failures_total",
                                           "Operations that the store could not do."};
inline constexpr MetricInfo kStoreWeakness{
    "arapd_store_weakness",
    "1 while the store may lose what it has acknowledged, or something else is wrong with it, by "
    "reason."};

// What was computed and is kept, by cache or kind.
inline constexpr MetricInfo kCacheHits{"arapd_cache_hits_total", "Look-ups that found something."};
inline constexpr MetricInfo kCacheMisses{"arapd_cache_misses_total",
                                         "Look-ups that found nothing."};
inline constexpr MetricInfo kEvictions{"arapd_evictions_total", "What a cache has let go."};
inline constexpr MetricInfo kEvictedBytes{"arapd_evicted_bytes_total",
                                          "Bytes of what a cache has let go."};
inline constexpr MetricInfo kBytes{"arapd_bytes",
                                   "Memory of what was computed and is kept, by kind."};
inline constexpr MetricInfo kEntries{"arapd_entries", "How many of them are kept."};
inline constexpr MetricInfo kAccountedBytes{
    "arapd_accounted_bytes",
    "Memory that counts towards max_bytes: what is kept, in use or reserved."};

// The process, under the names that Prometheus gives these everywhere.
inline constexpr MetricInfo kBuildInfo{"arapd_build_info", "Always 1; the version is the label."};
inline constexpr MetricInfo kResidentBytes{"process_resident_memory_bytes", "Memory in use."};
inline constexpr MetricInfo kOpenDescriptors{"process_open_fds", "Open file descriptors."};
inline constexpr MetricInfo kMaxDescriptors{"process_max_fds",
                                            "File descriptors that may be open."};
inline constexpr MetricInfo kThreads{"process_threads", "Threads."};
inline constexpr MetricInfo kProcessorSeconds{"process_cpu_seconds_total", "Processor time."};
inline constexpr MetricInfo kStartTime{"process_start_time_seconds",
                                       "When the server started, in seconds since 1970."};

}  // namespace metric

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
  kDraw,             // all drawings of a flattening
  kRebuild,          // a mesh or handle set made again from what is stored
};
inline constexpr std::size_t kPhases = 12;

// The label value of a phase: "register", "flatten_order".
const char* PhaseName(Phase phase);

// Thread-safe; one per server. A call costs well below a microsecond. Names and kinds come from the
// program and never from a request, so that there are few of them.
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

// Serves memory, descriptors, processor time, threads and start of this process, under the names
// that Prometheus gives them everywhere (process_…).
void WatchProcess(Metrics& metrics);
// Memory of this process that is there.
double ResidentBytes();

}  // namespace arap::runtime
