#include "client/cli/commands/compare.h"

#include <iterator>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "client/cli/report.h"

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
    panel.lines = {"no layout: " + ReasonOf(flat.error()), flat.error().message};
    last = flat.error();
    ++failed;
  }
  if (failed == contestants.size()) return Fail(*last);
  return panels;
}

std::string FormatTable(const std::vector<ComparisonPanel>& panels) {
  std::string out = fmt::format("{:<28}{:>8}{:>10}{:>12}{:>13}{:>10}{:>10}\n", "", "flipped",
                                "area", "stretch %", "compress. %", "angle °", "ARAP");
  for (const ComparisonPanel& panel : panels) {
    if (panel.flat.uv.empty()) {
      fmt::format_to(std::back_inserter(out), "{:<28}{}\n", panel.label, panel.lines.front());
      continue;
    }
    const Distortion& d = panel.flat.distortion;
    fmt::format_to(std::back_inserter(out),
                   "{:<28}{:>8}{:>10.4f}{:>12.3f}{:>13.3f}{:>10.3f}{:>10.4g}\n", panel.label,
                   d.flipped, d.area_ratio, d.mean_stretch_percent, d.mean_compression_percent,
                   d.mean_angle_degrees, d.arap_energy);
  }
  return out;
}

}  // namespace arap::cli
