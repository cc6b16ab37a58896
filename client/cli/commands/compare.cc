#include "client/cli/commands/compare.h"

#include <array>
#include <iterator>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "client/cli/adapt.h"
#include "client/cli/report.h"

namespace arap::cli {
namespace {

using client::Basis;
using client::FlattenAnchors;
using client::FlattenMethod;

struct Contestant {
  const char* label;
  FlattenMethod method;
  Basis basis;
  client::EdgeWeights weights;
  FlattenAnchors anchors;
  std::optional<std::uint32_t> refine;
  bool injective;
};

constexpr auto kCotangent = client::EdgeWeights::kCotangent;
constexpr auto kOwn = client::EdgeWeights::kDefault;
constexpr std::array<Contestant, 6> kContestants{{
    {"First step, as published", FlattenMethod::kFirstStep, Basis::kEdgeAsPublished, kCotangent,
     FlattenAnchors::kCenterEdge, std::nullopt, false},
    {"Second step, as published", FlattenMethod::kArapEdge, Basis::kEdgeAsPublished, kCotangent,
     FlattenAnchors::kCenterEdge, 0, false},
    {"Face cells, refined", FlattenMethod::kArapFace, Basis::kDefault, kOwn,
     FlattenAnchors::kDefault, std::nullopt, false},
    {"Least squares conformal", FlattenMethod::kLscm, Basis::kDefault, kOwn,
     FlattenAnchors::kSpectral, std::nullopt, false},
    {"Angle-based", FlattenMethod::kAbf, Basis::kDefault, kOwn, FlattenAnchors::kSpectral,
     std::nullopt, false},
    {"Injective", FlattenMethod::kArapFace, Basis::kDefault, kOwn, FlattenAnchors::kDefault,
     std::nullopt, true},
}};

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

Result<std::vector<ComparisonPanel>> CompareMethods(const client::FlattenOptions& base,
                                                    const FlattenCall& flatten) {
  std::vector<ComparisonPanel> panels;
  std::optional<Fault> last;
  std::size_t failed = 0;
  for (const Contestant& contestant : kContestants) {
    client::FlattenOptions options = base;
    options.method = contestant.method;
    options.energy.basis = contestant.basis;
    options.energy.weights = contestant.weights;
    options.anchors = contestant.anchors;
    options.refine = contestant.refine;
    options.injective = contestant.injective;
    ComparisonPanel& panel = panels.emplace_back();
    panel.label = contestant.label;
    const Result<client::FlatSurface> flat = flatten(options, contestant.label);
    if (flat) {
      panel.flat = ToModel(*flat);
      panel.lines = Lines(panel.flat.distortion);
      continue;
    }
    if (EndsAll(flat.error().kind)) return Fail(flat.error());
    panel.lines = {"no layout: " + ReasonOf(flat.error()), flat.error().message};
    last = flat.error();
    ++failed;
  }
  if (failed == kContestants.size()) return Fail(*last);
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
