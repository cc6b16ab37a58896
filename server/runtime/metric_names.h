// The names of all metrics and what they count. docs/operations.md explains them to operators.
#pragma once

namespace arap::runtime {

struct MetricInfo {
  const char* name;
  const char* help;
};

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
inline constexpr MetricInfo kGaveWay{"arapd_gave_way_total", "How often jobs waited for frames."};
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
}  // namespace arap::runtime
