#include "core/drawing/captions.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/base/code_point.h"

namespace arap {
namespace {

// As a label may show it.
std::string Cleaned(std::string_view name) {
  constexpr std::string_view kDots = "...";
  std::string clean;
  std::size_t cut = 0;  // where it would be if dots had to follow
  while (!name.empty()) {
    const CodePoint point(name);
    const std::string_view shown = point.IsHarmless() ? name.substr(0, point.length) : "?";
    if (clean.size() + shown.size() > kLongestPieceName) {
      clean.resize(cut);
      return clean.append(kDots);
    }
    clean += shown;
    if (clean.size() + kDots.size() <= kLongestPieceName) cut = clean.size();
    name.remove_prefix(point.length);
  }
  return clean;
}

// For each chart the number of its name in `names`, where 0 is none.
std::vector<std::size_t> Elected(const Flattening& flat, std::span<const NamedPart> parts,
                                 std::vector<std::string>& names) {
  std::map<std::string, std::size_t> numbers{{{}, 0}};
  names.emplace_back();
  std::vector<std::size_t> number_of;  // by part
  for (const NamedPart& part : parts) {
    std::string name = Cleaned(part.name);
    const auto [at, fresh] = numbers.try_emplace(name, names.size());
    if (fresh) names.push_back(std::move(name));
    number_of.push_back(at->second);
  }
  std::map<std::pair<std::uint32_t, std::size_t>, std::size_t> votes;  // by chart and name
  std::size_t next = 0;                                                // the part that comes next
  for (std::size_t t = 0; t < flat.triangle_chart.size(); ++t) {
    while (next < parts.size() && parts[next].first_triangle <= t) ++next;
    ++votes[{flat.triangle_chart[t], next == 0 ? 0 : number_of[next - 1]}];
  }
  std::vector<std::size_t> elected(flat.charts.size(), 0), most(flat.charts.size(), 0);
  for (const auto& [what, count] : votes) {
    const auto& [chart, name] = what;
    if (chart >= elected.size() || count <= most[chart]) continue;
    most[chart] = count;
    elected[chart] = name;
  }
  return elected;
}

}  // namespace

Status CheckParts(std::span<const NamedPart> parts, std::size_t triangles) {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::uint32_t first = parts[i].first_triangle;
    if (first < triangles && (i == 0 || parts[i - 1].first_triangle < first)) continue;
    return Fail(Fault(FaultKind::kInvalidOption,
                      fmt::format("parts[{}] begins with triangle {}: they come one after the "
                                  "other, and the surface has {} triangles.",
                                  i, first, triangles))
                    .Field(fmt::format("parts[{}].first_triangle", i))
                    .Detail("triangles", triangles));
  }
  return {};
}

std::vector<std::string> PieceNames(const Flattening& flat, std::span<const NamedPart> parts) {
  if (parts.empty()) return {};
  std::vector<std::string> names;
  const std::vector<std::size_t> elected = Elected(flat, parts, names);
  std::vector<std::size_t> pieces(names.size(), 0), last(names.size(), 0);  // by name
  for (const std::size_t name : elected) ++pieces[name];
  std::set<std::string> taken;
  for (std::size_t i = 1; i < names.size(); ++i) {
    if (pieces[i] == 1) taken.insert(names[i]);
  }
  std::vector<std::string> out;
  for (const std::size_t name : elected) {
    std::string& own = out.emplace_back(names[name]);
    if (name == 0 || pieces[name] == 1) continue;
    do {
      own = fmt::format("{} {}", names[name], ++last[name]);
    } while (!taken.insert(own).second);
  }
  return out;
}

namespace {

std::string SizeOf(const Bounds& box) {
  return fmt::format("{:.3f} × {:.3f} mm", box.width(), box.height());
}

// "piece 2", counted from 1, with its name where it has one.
std::string Named(const Pattern& pattern, std::size_t i) {
  const std::string& name = pattern.pieces[i].name;
  return fmt::format("piece {}{}", i + 1, name.empty() ? name : " (" + name + ")");
}

// Of the surface: each is the first copy of itself.
std::size_t VertexCount(const Flattening& flat) {
  std::size_t count = 0;
  while (count < flat.source.size() && flat.source[count] == count) ++count;
  return count;
}

}  // namespace

std::vector<std::string> Summary(const Flattening& flat, const Pattern& pattern) {
  const Distortion& d = flat.distortion;
  std::vector<std::string> lines{
      fmt::format("{} vertices, {} triangles, {} flipped; area {:.4f} of the surface's",
                  VertexCount(flat), flat.corner_uv.size(), d.flipped, d.area_ratio),
      fmt::format("stretch mean {:.3f} %, max {:.3f} %; compression mean {:.3f} %, max {:.3f} %",
                  d.mean_stretch_percent, d.max_stretch_percent, d.mean_compression_percent,
                  d.max_compression_percent),
      fmt::format(
          "angles mean {:.3f}°, max {:.3f}°; ARAP energy {:.3g}; symmetric Dirichlet {:.6g}",
          d.mean_angle_degrees, d.max_angle_degrees, d.arap_energy, d.symmetric_dirichlet)};
  int most = 0;
  for (const FlatChart& chart : flat.charts) {
    if (chart.refine_end == RefineEnd::kLimit) most = std::max(most, chart.refinements);
  }
  if (most > 0) lines.push_back(fmt::format("refined {} times, the limit: not converged", most));
  const std::size_t cuts = flat.cuts.size();
  if (flat.charts.size() > 1 || cuts > 0 || flat.overlaps) {
    lines.push_back(fmt::format("{} piece{}, {} edges cut, {} of them automatically{}",
                                flat.charts.size(), flat.charts.size() == 1 ? "" : "s", cuts,
                                flat.auto_cuts,
                                flat.overlaps ? "; the outline overlaps itself" : ""));
  }
  constexpr std::size_t kListed = 8;
  const std::size_t pieces = pattern.pieces.size();
  for (std::size_t i = 0; i < std::min(pieces, kListed); ++i) {
    lines.push_back(Named(pattern, i) + ": " + SizeOf(pattern.pieces[i].box));
  }
  if (pieces > kListed) lines.push_back(fmt::format("and {} more pieces", pieces - kListed));
  lines.push_back("sheet: " + SizeOf(pattern.Box()));
  return lines;
}

std::vector<Warning> SizeWarnings(const Pattern& pattern, std::string_view option) {
  constexpr double kShortest = 5, kLongest = 10'000;
  constexpr std::size_t kNamed = 10;
  Warning warning{"unlikely_size", 0, {}, {}};
  for (std::size_t i = 0; i < pattern.pieces.size(); ++i) {
    const Bounds& box = pattern.pieces[i].box;
    const double longer = std::max(box.width(), box.height());
    if (longer >= kShortest && longer <= kLongest) continue;
    if (warning.count == 0) {
      warning.message = fmt::format("{} is {}", Named(pattern, i), SizeOf(box));
      warning.message.front() = 'P';
    }
    if (++warning.count <= kNamed) warning.elements.push_back(static_cast<std::uint32_t>(i));
  }
  if (warning.count == 0) return {};
  if (warning.count > 1) {
    warning.message += fmt::format(", and {} more pieces are as unlikely", warning.count - 1);
  }
  warning.message += fmt::format("; {} says whether the surface is in mm, cm, m or in", option);
  return {warning};
}

}  // namespace arap
