#include "core/drawing/summary.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

namespace arap {
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
