#include "client/cli/svg/layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>

#include <fmt/format.h>

#include "client/cli/svg/document.h"
#include "client/cli/svg/mesh_lines.h"
#include "client/cli/svg/view.h"

namespace arap::cli {
namespace {

constexpr double kSize = 1000;
constexpr double kMargin = 40;
constexpr double kLegendHeight = 90;
constexpr double kLine = 28;
constexpr int kShades = 24;  // on each side of white

// shade from −kShades (blue) to kShades (red).
std::string Color(int shade) {
  constexpr std::array<double, 3> kBlue{33, 102, 172}, kWhite{250, 250, 250}, kRed{178, 24, 43};
  const auto& end = shade < 0 ? kBlue : kRed;
  const double t = std::sqrt(std::abs(shade) / static_cast<double>(kShades));
  std::array<int, 3> rgb{};
  for (std::size_t i = 0; i < 3; ++i) {
    rgb[i] = static_cast<int>(std::lround(std::lerp(kWhite[i], end[i], t)));
  }
  return fmt::format("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]);
}

// 1, 2 or 5 times a power of ten, at least `value`; the end of the colour scale.
double NiceAbove(double value) {
  constexpr double kSmallest = 1e-6;
  const double power = std::pow(10, std::floor(std::log10(std::max(value, kSmallest))));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= value) return factor * power;
  }
  return 10 * power;
}

std::string Legend(double range, double left, double top) {
  constexpr double kWidth = 480;
  constexpr double kShadeWidth = kWidth / (2 * kShades + 1);
  std::string out;
  for (int shade = -kShades; shade <= kShades; ++shade) {
    fmt::format_to(std::back_inserter(out),
                   "<rect x=\"{:.1f}\" y=\"{:.0f}\" width=\"{:.1f}\" height=\"22\" fill=\"{}\"/>\n",
                   left + (shade + kShades) * kShadeWidth, top, kShadeWidth + 0.5, Color(shade));
  }
  out += SvgText(left, top + 48, 20, fmt::format("-{:g} %", range));
  out += SvgText(left + kWidth / 2 - 8, top + 48, 20, "0");
  out += SvgText(left + kWidth - 50, top + 48, 20, fmt::format("+{:g} %", range));
  out += SvgText(left + kWidth + 30, top + 18, 20, "larger principal strain of each triangle");
  return out;
}

// One path per shade.
std::string Triangles(const Layout& layout, double range, const View& view) {
  std::map<int, Lines> by_shade;
  for (std::size_t t = 0; 3 * t + 2 < layout.triangles.size(); ++t) {
    const double strain =
        PrincipalStrainPercent(layout.singular_values[2 * t], layout.singular_values[2 * t + 1]);
    const double share = std::isfinite(strain) ? std::clamp(strain / range, -1.0, 1.0) : 1.0;
    const auto corners = layout.triangles.subspan(3 * t, 3);
    by_shade[static_cast<int>(std::lround(share * kShades))].emplace_back(corners.begin(),
                                                                          corners.end());
  }
  std::string out;
  for (const auto& [shade, lines] : by_shade) {
    fmt::format_to(std::back_inserter(out),
                   "<path fill=\"{}\" stroke=\"#8a8378\" stroke-opacity=\"0.5\" "
                   "stroke-width=\"0.6\" stroke-linejoin=\"round\" d=\"{}\"/>\n",
                   Color(shade), PathData(lines, /*closed=*/true, layout.uv, view));
  }
  return out;
}

}  // namespace

double PrincipalStrainPercent(double s1, double s2) {
  const double stretch = s1 - 1;
  const double compression = s2 - 1;
  return 100 * (std::abs(stretch) >= std::abs(compression) ? stretch : compression);
}

std::string FormatLayout(const Layout& layout) {
  Bounds bounds;
  bounds.Add(layout.uv);
  const double longer = std::max({bounds.width(), bounds.height(), 1e-300});
  const double width = std::max(kSize * bounds.width() / longer, kSize);
  const double height = kSize * bounds.height() / longer;
  const View view(bounds, kMargin, kMargin, width, height);

  double worst = 0;
  for (std::size_t t = 0; 2 * t + 1 < layout.singular_values.size(); ++t) {
    const double strain =
        PrincipalStrainPercent(layout.singular_values[2 * t], layout.singular_values[2 * t + 1]);
    if (std::isfinite(strain)) worst = std::max(worst, std::abs(strain));
  }
  const double range = NiceAbove(worst);
  std::string body = Triangles(layout, range, view);
  fmt::format_to(std::back_inserter(body),
                 "<path fill=\"none\" stroke=\"#2b2622\" stroke-width=\"4\" "
                 "stroke-linejoin=\"round\" d=\"{}\"/>\n",
                 PathData(BoundaryLines(layout.triangles), /*closed=*/true, layout.uv, view));

  double y = height + 2 * kMargin;
  body += Legend(range, kMargin, y);
  y += kLegendHeight;
  for (const std::string& line : layout.caption) {
    body += SvgText(kMargin, y, 20, line);
    y += kLine;
  }
  return SvgDocument(width + 2 * kMargin, y, body);
}

}  // namespace arap::cli
