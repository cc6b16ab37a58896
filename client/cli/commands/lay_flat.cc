#include "client/cli/commands/lay_flat.h"

#include <cstddef>
#include <optional>
#include <stop_token>
#include <utility>

#include <fmt/format.h>

#include "client/cli/patience.h"
#include "client/cli/report.h"
#include "core/base/try.h"

namespace arap::cli {
namespace {

struct Contestant {
  const char* label;
  FlattenOptions options;
};

std::vector<Contestant> Contestants() {
  std::vector<Contestant> all{
      {"First step, as published", FirstStepOptions(Basis::kEdgeAsPublished)},
      {"Second step, as published", ArapOptions(Basis::kEdgeAsPublished)},
      {"Face cells, refined", ArapOptions()},
      {"Least squares conformal", LscmOptions()},
      {"Angle-based", AbfOptions()},
      {"Injective", ArapOptions()},
  };
  all[1].options.refine = 0;
  all[5].options.injective = true;
  return all;
}

std::vector<std::string> Lines(const Distortion& d) {
  return {fmt::format("area {:.3f} of the surface's, {} flipped, ARAP energy {:.4g}", d.area_ratio,
                      d.flipped, d.arap_energy),
          fmt::format("stretch {:.2f} % on the average, {:.1f} % at worst", d.mean_stretch_percent,
                      d.max_stretch_percent),
          fmt::format("compression {:.2f} % on the average, {:.1f} % at worst",
                      d.mean_compression_percent, d.max_compression_percent),
          fmt::format("angles {:.2f}° on the average, {:.1f}° at worst", d.mean_angle_degrees,
                      d.max_angle_degrees)};
}

bool EndsAll(FaultKind kind) {
  return kind == FaultKind::kCancelled || kind == FaultKind::kDeadlineExceeded ||
         kind == FaultKind::kDraining || kind == FaultKind::kInternal;
}

}  // namespace

Result<client::FlatSurface> FlattenWaiting(const client::Client& client, const SurfaceMesh& mesh,
                                           client::FlattenQuery query,
                                           std::chrono::milliseconds timeout,
                                           const std::string& what) {
  query.float64 = true;
  query.singular_values = true;
  std::stop_source stop;
  // The call ends by itself; this is for one that does not.
  constexpr std::chrono::seconds kLonger{5};
  Patience patience(
      timeout + kLonger, [&stop] { stop.request_stop(); }, what);
  Result<client::FlatSurface> answer = client.Flatten(mesh, query, {timeout, stop.get_token()});
  if (!answer) return Fail(patience.Explain(answer.error()));
  return answer;
}

Result<client::FlatSurface> FlattenAsJob(const client::Client& client, const SurfaceMesh& mesh,
                                         client::FlattenQuery query,
                                         std::chrono::milliseconds timeout,
                                         const std::string& session, const std::string& job) {
  query.float64 = true;
  query.singular_values = true;
  std::stop_source stop;
  Patience patience(
      timeout, [&stop] { stop.request_stop(); }, "job " + job);
  const client::CallOptions call{
      .timeout = std::nullopt, .stop = stop.get_token(), .retry_within = timeout};
  const auto flatten = [&]() -> Result<client::FlatSurface> {
    client::SessionOptions options;
    options.id = session;
    TRY(const client::Session opened, client.CreateSession(options, call));
    TRY(const auto submitted, opened.SubmitFlatten(job, mesh, query, call));
    const auto heard = [&patience](const client::FlattenJob&) {
      patience.Heard();
      return true;
    };
    TRY(const auto ended, opened.WatchJob(job, heard, call));
    return opened.GetResult(job, mesh, query, call);
  };
  Result<client::FlatSurface> answer = flatten();
  if (!answer) return Fail(patience.Explain(answer.error()));
  return answer;
}

Result<std::vector<ComparisonPanel>> CompareMethods(const client::FlattenQuery& base,
                                                    const FlattenCall& flatten) {
  std::vector<ComparisonPanel> panels;
  std::optional<Fault> last;
  std::size_t failed = 0;
  const std::vector<Contestant> contestants = Contestants();
  for (const Contestant& contestant : contestants) {
    client::FlattenQuery query = base;
    query.options = contestant.options;
    query.options.energy.rigidity = base.options.energy.rigidity;
    query.options.refine_stop = base.options.refine_stop;
    query.options.cut = base.options.cut;
    query.options.pins = base.options.pins;
    query.options.grain_lines = base.options.grain_lines;
    ComparisonPanel& panel = panels.emplace_back();
    panel.label = contestant.label;
    Result<client::FlatSurface> flat = flatten(query, contestant.label);
    if (flat) {
      panel.flat = std::move(flat->flat);
      panel.lines = Lines(panel.flat.distortion);
      continue;
    }
    if (EndsAll(flat.error().kind)) return Fail(flat.error());
    panel.lines = {"no layout: " + ReasonOf(flat.error()), Printable(flat.error().message)};
    last = flat.error();
    ++failed;
  }
  if (failed == contestants.size()) return Fail(*last);
  return panels;
}

}  // namespace arap::cli
