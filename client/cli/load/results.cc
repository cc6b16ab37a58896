#include "client/cli/load/results.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "client/cli/load/document_reader.h"
#include "client/cli/report.h"

namespace arap::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kVersion = 1;

Percentiles InShort(const Histogram& times) {
  return {times.Quantile(0.5), times.Quantile(0.9), times.Quantile(0.99), times.Max()};
}

Json HistogramJson(const Histogram& times) {
  Json buckets = Json::object();
  for (const Histogram::Bucket& bucket : times.Buckets()) {
    buckets[fmt::format("{}", bucket.low)] = bucket.count;
  }
  Json json = ToJson(InShort(times));
  json.update({{"count", times.Count()},
               {"min", times.Min()},
               {"sum", times.Sum()},
               {"buckets", std::move(buckets)}});
  return json;
}

Json OperationJson(const OperationResults& done) {
  return {{"sent", done.sent},
          {"answered", done.answered},
          {"failed", done.failed},
          {"late", done.late},
          {"unsent", done.unsent},
          {"replaced", done.replaced},
          {"verified", done.verified},
          {"wrong", done.wrong},
          {"response_micros", HistogramJson(done.response)},
          {"service_micros", HistogramJson(done.service)},
          {"queue_micros", HistogramJson(done.queue)},
          {"solve_micros", HistogramJson(done.solve)}};
}

Json IntervalJson(const Interval& interval, const std::vector<Operation>& done) {
  Json operations = Json::object();
  for (const Operation operation : done) {
    const IntervalOperation& part = interval.operations[operation];
    operations[std::string(NameOf(operation))] = {
        {"offered", part.offered}, {"answered", part.answered}, {"failed", part.failed},
        {"p50_micros", part.p50},  {"p99_micros", part.p99},    {"max_micros", part.max},
        {"late", part.late},       {"unsent", part.unsent},     {"replaced", part.replaced}};
  }
  return {{"start", interval.start},
          {"seconds", interval.seconds},
          {"operations", std::move(operations)}};
}

void ReadOperations(DocumentReader& reader, const Json& json, LoadResults& results) {
  const Json* const operations = reader.Member(json, "", "operations", Json::value_t::object);
  if (operations == nullptr) return;
  for (const auto& [name, done] : operations->items()) {
    const std::string path = "operations." + Printable(name);
    const auto known = std::find(kOperationNames.begin(), kOperationNames.end(), name);
    if (known == kOperationNames.end()) return reader.Wrong(path, "is no operation");
    OperationResults& to =
        results.operations[static_cast<Operation>(known - kOperationNames.begin())];
    for (const auto& [member, count] :
         {std::pair("sent", &to.sent), std::pair("answered", &to.answered),
          std::pair("failed", &to.failed), std::pair("late", &to.late),
          std::pair("unsent", &to.unsent), std::pair("replaced", &to.replaced),
          std::pair("verified", &to.verified), std::pair("wrong", &to.wrong)}) {
      reader.Read(done, path, member, *count);
    }
    reader.Read(done, path, "response_micros", to.response);
    reader.Read(done, path, "service_micros", to.service);
    reader.Read(done, path, "queue_micros", to.queue);
    reader.Read(done, path, "solve_micros", to.solve);
  }
}

void ReadIntervals(DocumentReader& reader, const Json& json, LoadResults& results) {
  const Json* const intervals = reader.Member(json, "", "intervals", Json::value_t::array);
  if (intervals == nullptr) return;
  for (std::size_t i = 0; i < intervals->size(); ++i) {
    const Json& from = (*intervals)[i];
    const std::string path = fmt::format("intervals[{}]", i);
    Interval& to = results.intervals.emplace_back();
    reader.Read(from, path, "start", to.start);
    reader.Read(from, path, "seconds", to.seconds);
    const Json* const operations = reader.Member(from, path, "operations", Json::value_t::object);
    if (operations == nullptr) return;
    for (std::size_t k = 0; k < kOperations; ++k) {
      const auto found = operations->find(std::string(kOperationNames[k]));
      if (found == operations->end()) continue;
      const std::string here = fmt::format("{}.operations.{}", path, kOperationNames[k]);
      IntervalOperation& part = to.operations[static_cast<Operation>(k)];
      reader.Read(*found, here, "offered", part.offered);
      reader.Read(*found, here, "answered", part.answered);
      reader.Read(*found, here, "failed", part.failed);
      reader.Read(*found, here, "p50_micros", part.p50);
      reader.Read(*found, here, "p99_micros", part.p99);
      reader.Read(*found, here, "max_micros", part.max);
      // Documents of before these were told of have none of them.
      for (const auto& [name, count] :
           {std::pair("late", &part.late), std::pair("unsent", &part.unsent),
            std::pair("replaced", &part.replaced)}) {
        if (found->contains(name)) reader.Read(*found, here, name, *count);
      }
    }
  }
}

void ReadSteps(DocumentReader& reader, const Json& json, LoadResults& results) {
  const Json* const steps = reader.Member(json, "", "steps", Json::value_t::array);
  if (steps == nullptr) return;
  for (std::size_t i = 0; i < steps->size(); ++i) {
    const std::string path = fmt::format("steps[{}]", i);
    LoadStep& to = results.steps.emplace_back();
    reader.Read((*steps)[i], path, "rate", to.rate);
    reader.Read((*steps)[i], path, "answered_per_second", to.answered);
    reader.Read((*steps)[i], path, "seconds", to.seconds);
    reader.Read((*steps)[i], path, "p50_micros", to.p50);
    reader.Read((*steps)[i], path, "p99_micros", to.p99);
    reader.Read((*steps)[i], path, "met", to.met);
  }
  if (json.contains("rate_found")) {
    double rate = 0;
    reader.Read(json, "", "rate_found", rate);
    results.rate_found = rate;
  }
}

void ReadErrors(DocumentReader& reader, const Json& json, LoadResults& results) {
  const Json* const errors = reader.Member(json, "", "error_kinds", Json::value_t::array);
  if (errors == nullptr) return;
  for (std::size_t i = 0; i < errors->size(); ++i) {
    const std::string path = fmt::format("error_kinds[{}]", i);
    LoadError& to = results.errors.emplace_back();
    reader.Read((*errors)[i], path, "code", to.code);
    reader.Read((*errors)[i], path, "reason", to.reason);
    reader.Read((*errors)[i], path, "count", to.count);
    reader.Read((*errors)[i], path, "first", to.first);
  }
}

}  // namespace

void OperationResults::Add(const OperationResults& more) {
  response.Merge(more.response);
  service.Merge(more.service);
  queue.Merge(more.queue);
  solve.Merge(more.solve);
  sent += more.sent;
  answered += more.answered;
  failed += more.failed;
  late += more.late;
  unsent += more.unsent;
  replaced += more.replaced;
  verified += more.verified;
  wrong += more.wrong;
}

std::vector<Operation> LoadResults::Done() const {
  std::vector<Operation> done;
  for (std::size_t k = 0; k < kOperations; ++k) {
    const auto operation = static_cast<Operation>(k);
    if (operations[operation].Any()) done.push_back(operation);
  }
  return done;
}

OperationResults LoadResults::Total() const {
  OperationResults total;
  for (const OperationResults& done : operations) total.Add(done);
  return total;
}

double LoadResults::PerSecond(std::uint64_t count) const {
  return seconds > 0 ? static_cast<double>(count) / seconds : 0;
}

nlohmann::ordered_json ToJson(const LoadResults& results) {
  const OperationResults& drag = results.operations[Operation::kDrag];
  const std::vector<Operation> done = results.Done();
  Json errors = Json::object(), kinds = Json::array();
  for (const LoadError& error : results.errors) {
    Json& of_reason = errors[error.reason];
    of_reason = error.count + (of_reason.is_null() ? 0 : of_reason.get<std::uint64_t>());
    kinds.push_back({{"code", error.code},
                     {"reason", error.reason},
                     {"count", error.count},
                     {"first", error.first}});
  }
  Json json{{"version", kVersion},
            {"how", results.how},
            {"settings", results.settings},
            {"sessions", results.sessions},
            {"streams", results.streams},
            {"connections", results.connections},
            {"vertices", results.vertices},
            {"handles", results.handles},
            {"seconds", results.seconds},
            {"warm_up_seconds", results.warm_up_seconds},
            {"updates", drag.answered},
            {"updates_per_second", results.PerSecond(drag.answered)},
            {"round_trip_micros", ToJson(InShort(drag.response))},
            {"queue_micros", ToJson(InShort(drag.queue))},
            {"solve_micros", ToJson(InShort(drag.solve))},
            {"streams_refused", results.refused.Count()},
            {"refused_micros", HistogramJson(results.refused)},
            {"resumptions", results.resumptions},
            {"frames_lost", results.frames_lost},
            {"echo_micros", HistogramJson(results.echo)},
            {"own_nanos_per_message", results.own_nanos_per_message},
            {"errors", std::move(errors)},
            {"error_kinds", std::move(kinds)},
            {"operations", Json::object()}};
  for (const Operation operation : done) {
    json["operations"][std::string(NameOf(operation))] =
        OperationJson(results.operations[operation]);
  }
  if (results.transport) {
    json["transport"] = {{"seconds", results.transport->seconds},
                         {"per_second", results.transport->PerSecond()},
                         {"round_trip_micros", HistogramJson(results.transport->round_trip)}};
  }
  Json& steps = json["steps"] = Json::array();
  for (const LoadStep& step : results.steps) {
    steps.push_back({{"rate", step.rate},
                     {"answered_per_second", step.answered},
                     {"seconds", step.seconds},
                     {"p50_micros", step.p50},
                     {"p99_micros", step.p99},
                     {"met", step.met}});
  }
  if (results.rate_found) json["rate_found"] = *results.rate_found;
  Json& intervals = json["intervals"] = Json::array();
  for (const Interval& interval : results.intervals) {
    intervals.push_back(IntervalJson(interval, done));
  }
  return json;
}

Result<LoadResults> LoadResultsFromJson(const nlohmann::ordered_json& json) {
  DocumentReader reader;
  LoadResults results;
  if (!json.is_object() || !json.contains("round_trip_micros")) {
    return Fail(FaultKind::kInvalidOption, "That is not what `arapctl load --json` writes.");
  }
  std::uint64_t version = 0;
  if (json.contains("version")) reader.Read(json, "", "version", version);
  if (version == 0) {
    reader.Wrong("version", "is not there: an older arapctl wrote this, without histograms");
  } else if (version > kVersion) {
    reader.Wrong("version", fmt::format("is {}: a newer arapctl wrote this", version));
  }
  reader.Read(json, "", "how", results.how);
  if (const Json* const settings = reader.Member(json, "", "settings", Json::value_t::object)) {
    results.settings = *settings;
  }
  for (const auto& [name, count] :
       {std::pair("sessions", &results.sessions), std::pair("streams", &results.streams),
        std::pair("connections", &results.connections), std::pair("vertices", &results.vertices),
        std::pair("handles", &results.handles)}) {
    reader.Read(json, "", name, *count);
  }
  reader.Read(json, "", "seconds", results.seconds);
  reader.Read(json, "", "warm_up_seconds", results.warm_up_seconds);
  reader.Read(json, "", "refused_micros", results.refused);
  reader.Read(json, "", "resumptions", results.resumptions);
  reader.Read(json, "", "frames_lost", results.frames_lost);
  reader.Read(json, "", "echo_micros", results.echo);
  reader.Read(json, "", "own_nanos_per_message", results.own_nanos_per_message);
  if (const auto transport = json.find("transport"); transport != json.end()) {
    results.transport.emplace();
    reader.Read(*transport, "transport", "seconds", results.transport->seconds);
    reader.Read(*transport, "transport", "round_trip_micros", results.transport->round_trip);
  }
  ReadOperations(reader, json, results);
  ReadIntervals(reader, json, results);
  ReadSteps(reader, json, results);
  ReadErrors(reader, json, results);
  if (reader.fault()) return Fail(*reader.fault());
  return results;
}

}  // namespace arap::cli
