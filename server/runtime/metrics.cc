#include "server/runtime/metrics.h"

#include <array>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <map>
#include <span>
#include <system_error>

#include <prometheus/counter.h>
#include <prometheus/family.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>
#include <prometheus/text_serializer.h>
#include <sys/resource.h>
#include <unistd.h>

#include "core/base/mutex.h"

namespace arap::runtime {
namespace {

using prometheus::Counter;
using prometheus::Histogram;
using prometheus::Registry;

// From a fifth of a frame of a small mesh to the flattening of a million triangles.
// Nothing with a destructor: calls that end late are counted while the process already ends.
constexpr std::array kSeconds = {0.0001, 0.00025, 0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025, 0.05,
                                 0.1,    0.25,    0.5,    1.0,   2.5,    5.0,   10.0, 30.0,  60.0};
// From a drag to a day's work.
constexpr std::array kLifetimes = {1.0, 10.0, 60.0, 300.0, 1'800.0, 7'200.0, 28'800.0};

// The metrics of one family, found by the values of their labels without building a label map.
template <class Metric>
class Series {
 public:
  Series(prometheus::Family<Metric>& family, std::string label,
         std::span<const double> bounds = kSeconds)
      : family_(family), label_(std::move(label)), bounds_(bounds) {}

  Metric& Of(std::string_view value) {
    const MutexLock lock(&mutex_);
    if (const auto found = metrics_.find(value); found != metrics_.end()) return *found->second;
    return *metrics_.emplace(value, Add(std::string(value))).first->second;
  }

 private:
  Metric* Add(const std::string& value) {
    if constexpr (std::is_same_v<Metric, Histogram>) {
      return &family_.Add({{label_, value}},
                          Histogram::BucketBoundaries(bounds_.begin(), bounds_.end()));
    } else {
      return &family_.Add({{label_, value}});
    }
  }

  prometheus::Family<Metric>& family_;
  const std::string label_;
  const std::span<const double> bounds_;
  Mutex mutex_;
  std::map<std::string, Metric*, std::less<>> metrics_ ABSL_GUARDED_BY(mutex_);
};

prometheus::Family<Counter>& CounterFamily(Registry& registry, const MetricInfo& info) {
  return prometheus::BuildCounter().Name(info.name).Help(info.help).Register(registry);
}

Series<Counter> Counters(Registry& registry, const MetricInfo& info, const char* label) {
  return {CounterFamily(registry, info), label};
}

Series<Histogram> Histograms(Registry& registry, const MetricInfo& info, const char* label,
                             std::span<const double> bounds = kSeconds) {
  return {prometheus::BuildHistogram().Name(info.name).Help(info.help).Register(registry), label,
          bounds};
}

// What Watch was asked for.
struct Watched {
  std::string name;
  std::string help;
  prometheus::MetricType type;
  struct Value {
    std::vector<prometheus::ClientMetric::Label> labels;
    std::function<double()> read;
  };
  std::vector<Value> values;
};

prometheus::MetricFamily Read(const Watched& watched) {
  prometheus::MetricFamily family{watched.name, watched.help, watched.type, {}};
  for (const Watched::Value& value : watched.values) {
    prometheus::ClientMetric metric;
    metric.label = value.labels;
    (watched.type == prometheus::MetricType::Counter ? metric.counter.value : metric.gauge.value) =
        value.read();
    family.metric.push_back(std::move(metric));
  }
  return family;
}

double OpenDescriptors() {
  double count = -1;  // the one that reads the directory
  std::error_code error;
  for (std::filesystem::directory_iterator entry("/proc/self/fd", error), end;
       !error && entry != end; entry.increment(error)) {
    ++count;
  }
  return count < 0 ? 0 : count;
}

double MaxDescriptors() {
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  return static_cast<double>(limit.rlim_cur);
}

double Threads() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double threads = 0;
    if (word == "Threads:" && status >> threads) return threads;
  }
  return 0;
}

double ProcessorSeconds() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

}  // namespace

const char* PhaseName(Phase phase) {
  switch (phase) {
    case Phase::kRegister:
      return "register";
    case Phase::kCompile:
      return "compile";
    case Phase::kEdit:
      return "edit";
    case Phase::kFrame:
      return "frame";
    case Phase::kTrack:
      return "track";
    case Phase::kFlatten:
      return "flatten";
    case Phase::kFlattenTopology:
      return "flatten_topology";
    case Phase::kFlattenOrder:
      return "flatten_order";
    case Phase::kFlattenFactor:
      return "flatten_factor";
    case Phase::kFlattenSolve:
      return "flatten_solve";
    case Phase::kDraw:
      return "draw";
    case Phase::kRebuild:
      return "rebuild";
  }
  return "";
}

struct Metrics::Impl {
  Registry registry;
  prometheus::Family<Counter>& rpcs = CounterFamily(registry, metric::kRpcs);
  Mutex rpcs_mutex;
  // By method, then code.
  std::map<std::string, std::map<std::string, Counter*, std::less<>>, std::less<>> rpc_counters
      ABSL_GUARDED_BY(rpcs_mutex);

  Series<Histogram> rpc_seconds = Histograms(registry, metric::kRpcSeconds, "method");
  Series<Histogram> stream_seconds =
      Histograms(registry, metric::kStreamSeconds, "method", kLifetimes);
  Series<Histogram> queue_seconds = Histograms(registry, metric::kQueueSeconds, "lane");
  Series<Histogram> phase_seconds = Histograms(registry, metric::kPhaseSeconds, "phase");
  Series<Histogram> store_seconds = Histograms(registry, metric::kStoreSeconds, "op");
  Series<Counter> store_failures = Counters(registry, metric::kStoreFailures, "op");
  Series<Counter> cache_hits = Counters(registry, metric::kCacheHits, "cache");
  Series<Counter> cache_misses = Counters(registry, metric::kCacheMisses, "cache");
  Series<Counter> evictions = Counters(registry, metric::kEvictions, "cache");
  Series<Counter> evicted_bytes = Counters(registry, metric::kEvictedBytes, "cache");
  Series<Counter> rejected = Counters(registry, metric::kRejected, "quota");
  Counter& coalesced = CounterFamily(registry, metric::kCoalesced).Add({});
  std::array<Histogram*, kPhases> phases{};

  Mutex watched_mutex;
  std::vector<Watched> watched ABSL_GUARDED_BY(watched_mutex);

  // Phases are served from the start, also those that have not happened yet.
  Impl() {
    for (std::size_t i = 0; i < kPhases; ++i) {
      phases[i] = &phase_seconds.Of(PhaseName(static_cast<runtime::Phase>(i)));
    }
  }

  Counter& Rpcs(std::string_view method, std::string_view code) {
    const MutexLock lock(&rpcs_mutex);
    auto codes = rpc_counters.find(method);
    if (codes == rpc_counters.end()) codes = rpc_counters.try_emplace(std::string(method)).first;
    if (const auto found = codes->second.find(code); found != codes->second.end()) {
      return *found->second;
    }
    Counter& counter = rpcs.Add({{"method", std::string(method)}, {"code", std::string(code)}});
    codes->second.emplace(code, &counter);
    return counter;
  }
};

Metrics::Metrics() : impl_(std::make_unique<Impl>()) {}

Metrics::~Metrics() = default;

void Metrics::Rpc(std::string_view method, std::string_view code, double seconds) {
  impl_->Rpcs(method, code).Increment();
  impl_->rpc_seconds.Of(method).Observe(seconds);
}

void Metrics::Stream(std::string_view method, std::string_view code, double seconds) {
  impl_->Rpcs(method, code).Increment();
  impl_->stream_seconds.Of(method).Observe(seconds);
}

void Metrics::Queue(std::string_view lane, double seconds) {
  impl_->queue_seconds.Of(lane).Observe(seconds);
}

void Metrics::Phase(runtime::Phase phase, double seconds) {
  impl_->phases.at(static_cast<std::size_t>(phase))->Observe(seconds);
}

void Metrics::Store(std::string_view operation, double seconds, bool ok) {
  impl_->store_seconds.Of(operation).Observe(seconds);
  Counter& failures = impl_->store_failures.Of(operation);
  if (!ok) failures.Increment();
}

void Metrics::ServeCache(std::string_view cache) {
  for (Series<Counter>* series :
       {&impl_->cache_hits, &impl_->cache_misses, &impl_->evictions, &impl_->evicted_bytes}) {
    series->Of(cache);
  }
}

void Metrics::ServeQuota(std::string_view quota) { impl_->rejected.Of(quota); }

void Metrics::CacheHit(std::string_view cache) { impl_->cache_hits.Of(cache).Increment(); }

void Metrics::CacheMiss(std::string_view cache) { impl_->cache_misses.Of(cache).Increment(); }

void Metrics::Evicted(std::string_view cache, std::size_t bytes) {
  impl_->evictions.Of(cache).Increment();
  impl_->evicted_bytes.Of(cache).Increment(static_cast<double>(bytes));
}

void Metrics::Coalesced(std::size_t updates) {
  impl_->coalesced.Increment(static_cast<double>(updates));
}

void Metrics::Rejected(std::string_view quota) { impl_->rejected.Of(quota).Increment(); }

void Metrics::Watch(const MetricInfo& info, Kind kind, const Labels& labels,
                    std::function<double()> read) {
  Watched::Value value;
  for (const auto& [key, text] : labels) value.labels.push_back({key, text});
  value.read = std::move(read);
  const MutexLock lock(&impl_->watched_mutex);
  for (Watched& watched : impl_->watched) {
    if (watched.name == info.name) {
      watched.values.push_back(std::move(value));
      return;
    }
  }
  impl_->watched.push_back(
      {info.name,
       info.help,
       kind == Kind::kCounter ? prometheus::MetricType::Counter : prometheus::MetricType::Gauge,
       {}});
  impl_->watched.back().values.push_back(std::move(value));
}

std::string Metrics::Text() const {
  std::vector<prometheus::MetricFamily> families = impl_->registry.Collect();
  {
    const MutexLock lock(&impl_->watched_mutex);
    for (const Watched& watched : impl_->watched) families.push_back(Read(watched));
  }
  return prometheus::TextSerializer().Serialize(families);
}

double ResidentBytes() {
  std::ifstream statm("/proc/self/statm");
  double size = 0, resident = 0;
  statm >> size >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

void WatchProcess(Metrics& metrics) {
  using Kind = Metrics::Kind;
  metrics.Watch(metric::kResidentBytes, Kind::kGauge, {}, ResidentBytes);
  metrics.Watch(metric::kOpenDescriptors, Kind::kGauge, {}, OpenDescriptors);
  metrics.Watch(metric::kMaxDescriptors, Kind::kGauge, {}, MaxDescriptors);
  metrics.Watch(metric::kThreads, Kind::kGauge, {}, Threads);
  metrics.Watch(metric::kProcessorSeconds, Kind::kCounter, {}, ProcessorSeconds);
  const auto start = static_cast<double>(std::time(nullptr));
  metrics.Watch(metric::kStartTime, Kind::kGauge, {}, [start] { return start; });
}

}  // namespace arap::runtime
