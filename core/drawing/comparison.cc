#include "core/drawing/comparison.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "core/drawing/front_view.h"
#include "core/drawing/strain.h"
#include "core/drawing/svg.h"

namespace arap {
namespace {

constexpr double kLongerSide = 420;  // of the largest picture
constexpr double kGap = 30;
constexpr double kLeastWidth = 620;  // of a panel, for its text
constexpr double kLabel = 40;
constexpr double kText = 21, kLine = 29;
constexpr std::size_t kColumns = 3;
constexpr double kSquares = 14;  // across the surface

// The flat positions turned so that they lie as the surface is seen.
std::vector<Complex> Turned(const Flattening& flat, const FrontView& front) {
  std::vector<Complex> seen, laid;
  for (const Triangle& t : flat.corner_uv) {
    for (const std::uint32_t u : t) {
      seen.push_back(front.points()[flat.source[u]]);
      laid.push_back(flat.uv[u]);
    }
  }
  Complex seen_middle, laid_middle, sum;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    seen_middle += seen[i] / static_cast<double>(seen.size());
    laid_middle += laid[i] / static_cast<double>(seen.size());
  }
  for (std::size_t i = 0; i < seen.size(); ++i) {
    sum += std::conj(laid[i] - laid_middle) * (seen[i] - seen_middle);
  }
  const Complex turn = std::abs(sum) > 0 ? sum / std::abs(sum) : 1;
  std::vector<Complex> uv;
  for (const Complex p : flat.uv) uv.push_back(turn * p);
  return uv;
}

Bounds BoundsOf(std::span<const Complex> points, std::span<const Triangle> used) {
  Bounds bounds;
  for (const Triangle& t : used) {
    for (const std::uint32_t i : t) bounds.Add(points[i]);
  }
  return bounds;
}

// Wider and higher on all sides, so that a view of it has the scale of every other.
Bounds Widened(const Bounds& b, double width, double height) {
  const double x = (width - b.width()) / 2, y = (height - b.height()) / 2;
  return {b.min_x - x, b.min_y - y, b.max_x + x, b.max_y + y, false};
}

std::string FlatPicture(const Flattening& flat, const std::vector<Complex>& uv, double range,
                        const View& view) {
  std::string out;
  for (const auto& [shade, lines] : TrianglesByShade(flat.corner_uv, flat.singular_values, range)) {
    fmt::format_to(std::back_inserter(out),
                   "<path fill=\"{}\" stroke=\"#8a8378\" stroke-opacity=\"0.4\" "
                   "stroke-width=\"0.5\" d=\"{}\"/>\n",
                   StrainColor(shade), PathData(lines, /*closed=*/true, uv, view));
  }
  fmt::format_to(std::back_inserter(out),
                 "<path fill=\"none\" stroke=\"#2b2622\" stroke-width=\"2\" d=\"{}\"/>\n",
                 PathData(BoundaryLines(flat.corner_uv), /*closed=*/true, uv, view));
  return out;
}

std::string Legend(double range, double left, double top) {
  constexpr double kWidth = 480, kShadeWidth = kWidth / (2 * kStrainShades + 1);
  std::string out;
  for (int shade = -kStrainShades; shade <= kStrainShades; ++shade) {
    fmt::format_to(std::back_inserter(out),
                   "<rect x=\"{:.1f}\" y=\"{:.0f}\" width=\"{:.1f}\" height=\"22\" fill=\"{}\"/>\n",
                   left + (shade + kStrainShades) * kShadeWidth, top, kShadeWidth + 0.5,
                   StrainColor(shade));
  }
  out += SvgText(left, top + 48, kText, fmt::format("-{:g} %", range));
  out += SvgText(left + kWidth / 2 - 6, top + 48, kText, "0");
  out += SvgText(left + kWidth - 66, top + 48, kText, fmt::format("+{:g} %", range));
  return out +
         SvgText(left + kWidth + 30, top + 17, kText,
                 "larger principal strain of each triangle; stronger ones have the last colour");
}

// The strain that all but one in fifty triangles of all panels stay under: a few spikes would leave
// nothing of the colours for the rest.
double CommonStrain(const std::vector<ComparisonPanel>& panels) {
  std::vector<double> strains;
  for (const ComparisonPanel& panel : panels) {
    for (const auto& [s1, s2] : panel.flat.singular_values) {
      const double strain = std::abs(PrincipalStrainPercent(s1, s2));
      if (std::isfinite(strain) && s1 > 0) strains.push_back(strain);
    }
  }
  if (strains.empty()) return 0;
  const auto at = strains.begin() + static_cast<std::ptrdiff_t>(strains.size() * 49 / 50);
  std::nth_element(strains.begin(), at, strains.end());
  return *at;
}

}  // namespace

std::string FormatComparison(const SurfaceMesh& mesh, const std::vector<ComparisonPanel>& panels,
                             const std::string& caption) {
  const FrontView front(mesh);
  const Bounds seen = BoundsOf(front.points(), mesh.triangles);
  double width = seen.width(), height = seen.height();
  std::vector<std::vector<Complex>> layouts;
  std::size_t most_lines = 0;
  for (const ComparisonPanel& panel : panels) {
    layouts.push_back(Turned(panel.flat, front));
    const Bounds bounds = BoundsOf(layouts.back(), panel.flat.corner_uv);
    width = std::max(width, bounds.width());
    height = std::max(height, bounds.height());
    most_lines = std::max(most_lines, panel.lines.size());
  }
  const double scale = kLongerSide / std::max({width, height, 1e-300});
  const double box_width = scale * width, box_height = scale * height;
  const double panel_width = std::max(2 * box_width + kGap, kLeastWidth);
  const double panel_height =
      kLabel + box_height + kLine * (static_cast<double>(most_lines) + 1) + kGap;
  const double square = std::max(seen.width(), seen.height()) / kSquares;
  const double range = StrainRange(CommonStrain(panels));

  std::string body;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const ComparisonPanel& panel = panels[i];
    const std::size_t row = i / kColumns;
    const double left = kGap + static_cast<double>(i % kColumns) * (panel_width + 2 * kGap);
    const double top = kGap + static_cast<double>(row) * panel_height;
    body += SvgText(left, top + 26, 28, panel.label);
    if (!panel.flat.uv.empty()) {
      const View surface(Widened(seen, width, height), left, top + kLabel, box_width, box_height);
      body += CheckeredSurface(mesh, front, layouts[i], panel.flat.corner_uv, square, surface);
      const Bounds bounds = BoundsOf(layouts[i], panel.flat.corner_uv);
      const View plane(Widened(bounds, width, height), left + box_width + kGap, top + kLabel,
                       box_width, box_height);
      body += FlatPicture(panel.flat, layouts[i], range, plane);
    }
    double y = top + kLabel + box_height + kLine;
    for (const std::string& line : panel.lines) {
      body += SvgText(left, y, kText, line);
      y += kLine;
    }
  }
  const auto columns = static_cast<double>(std::min(kColumns, panels.size()));
  const auto rows = static_cast<double>((panels.size() + kColumns - 1) / kColumns);
  const double bottom = kGap + rows * panel_height;
  body += Legend(range, kGap, bottom);
  body += SvgText(kGap, bottom + 94, kText, caption);
  return SvgDocument(kGap + columns * (panel_width + 2 * kGap) - kGap, bottom + 116, body);
}

}  // namespace arap
