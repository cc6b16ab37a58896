#include "core/drawing/svg.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

namespace arap {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;
using Neighbours = std::map<std::uint32_t, std::set<std::uint32_t>>;

std::set<Edge> DirectedEdges(std::span<const Triangle> triangles) {
  std::set<Edge> edges;
  for (const Triangle& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) edges.emplace(t[k], t[(k + 1) % 3]);
  }
  return edges;
}

// Walks from `start` along unused edges until there is none, and uses them up.
std::vector<std::uint32_t> Walk(std::uint32_t start, bool both_ways, Neighbours& unused) {
  std::vector<std::uint32_t> line{start};
  for (auto at = unused.find(start); at != unused.end() && !at->second.empty();
       at = unused.find(line.back())) {
    const std::uint32_t next = *at->second.begin();
    at->second.erase(next);
    if (both_ways) unused[next].erase(line.back());
    line.push_back(next);
  }
  return line;
}

Lines WalkAll(bool both_ways, Neighbours unused) {
  Lines lines;
  for (auto at = unused.begin(); at != unused.end(); ++at) {
    while (!at->second.empty()) lines.push_back(Walk(at->first, both_ways, unused));
  }
  return lines;
}

// Of triangle t; 0 when it was left out or nothing is known.
double StrainOf(std::span<const std::array<double, 2>> singular_values, std::size_t t) {
  if (t >= singular_values.size()) return 0;
  const auto [s1, s2] = singular_values[t];
  return s1 == 0 && s2 == 0 ? 0 : PrincipalStrainPercent(s1, s2);
}

}  // namespace

Lines BoundaryLines(std::span<const Triangle> triangles) {
  const std::set<Edge> edges = DirectedEdges(triangles);
  Neighbours boundary;
  for (const auto& [a, b] : edges) {
    if (!edges.contains({b, a})) boundary[a].insert(b);
  }
  Lines lines = WalkAll(/*both_ways=*/false, std::move(boundary));
  for (auto& line : lines) {
    if (line.size() > 1 && line.front() == line.back()) line.pop_back();
  }
  return lines;
}

Lines InnerLines(std::span<const Triangle> triangles) {
  const std::set<Edge> edges = DirectedEdges(triangles);
  Neighbours inner;
  for (const auto& [a, b] : edges) {
    if (edges.contains({b, a})) inner[a].insert(b);
  }
  return WalkAll(/*both_ways=*/true, std::move(inner));
}

View::View(const Bounds& bounds, double left, double top, double width, double height) {
  const double along_x = bounds.width() > 0 ? width / bounds.width() : INFINITY;
  const double along_y = bounds.height() > 0 ? height / bounds.height() : INFINITY;
  scale_ = std::min(along_x, along_y);
  if (!std::isfinite(scale_)) scale_ = 1;  // a single point
  offset_x_ = left + (width - scale_ * bounds.width()) / 2 - scale_ * bounds.min_x;
  offset_y_ = top + (height - scale_ * bounds.height()) / 2 + scale_ * bounds.max_y;
}

long View::X(double x) const { return std::lround(offset_x_ + scale_ * x); }
long View::Y(double y) const { return std::lround(offset_y_ - scale_ * y); }

std::string PathData(std::span<const Complex> points, bool closed, const View& view) {
  std::string out;
  long x = 0, y = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    // Differences of rounded places: nothing adds up along the line.
    const long next_x = view.X(points[i].real());
    const long next_y = view.Y(points[i].imag());
    const long dx = next_x - x;
    const long dy = next_y - y;
    const char* const lead = i == 0 ? "M" : i == 1 ? "l" : dx < 0 ? "" : " ";
    fmt::format_to(std::back_inserter(out), "{}{}{}{}", lead, dx, dy < 0 ? "" : " ", dy);
    x = next_x;
    y = next_y;
  }
  return closed ? out + 'z' : out;
}

std::string PathData(const Lines& lines, bool closed, std::span<const Complex> positions,
                     const View& view) {
  std::string out;
  std::vector<Complex> points;
  for (const auto& line : lines) {
    points.clear();
    for (const std::uint32_t i : line) points.push_back(positions[i]);
    out += PathData(points, closed, view);
  }
  return out;
}

std::string SvgNumber(double value, int digits) {
  std::string text = fmt::format("{:.{}f}", value, digits);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text == "-0" ? "0" : text;
}

std::string SvgEscaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string SvgDocument(double width, double height, std::string_view body) {
  return fmt::format(
      R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {0:.0f} {1:.0f}" width="{0:.0f}" height="{1:.0f}">)"
      "\n<rect width=\"100%\" height=\"100%\" fill=\"#fbf9f5\"/>\n{2}</svg>\n",
      width, height, body);
}

std::string SvgText(double x, double y, double size, std::string_view text, int digits) {
  return fmt::format(
      R"(<text x="{:.{}f}" y="{:.{}f}" font-family="sans-serif" font-size="{:.{}f}" fill="#4a4038">{}</text>)"
      "\n",
      x, digits, y, digits, size, digits, SvgEscaped(text));
}

double PrincipalStrainPercent(double s1, double s2) {
  const double stretch = s1 - 1;
  const double compression = s2 - 1;
  return 100 * (std::abs(stretch) >= std::abs(compression) ? stretch : compression);
}

double LargestStrainPercent(std::span<const std::array<double, 2>> singular_values) {
  double largest = 0;
  for (std::size_t t = 0; t < singular_values.size(); ++t) {
    const double strain = StrainOf(singular_values, t);
    if (std::isfinite(strain)) largest = std::max(largest, std::abs(strain));
  }
  return largest;
}

double StrainRange(double percent) {
  constexpr double kSmallest = 1e-6;
  constexpr double kRounding = 1e-9;  // 100 · (1.02 − 1) is a little more than 2
  percent = std::max(percent * (1 - kRounding), kSmallest);
  const double power = std::pow(10, std::floor(std::log10(percent)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= percent) return factor * power;
  }
  return 10 * power;
}

std::string StrainColor(int shade) {
  constexpr std::array<double, 3> kBlue{33, 102, 172}, kWhite{250, 250, 250}, kRed{178, 24, 43};
  const auto& end = shade < 0 ? kBlue : kRed;
  const double t = std::sqrt(std::abs(shade) / static_cast<double>(kStrainShades));
  std::array<int, 3> rgb{};
  for (std::size_t i = 0; i < 3; ++i) {
    rgb[i] = static_cast<int>(std::lround(std::lerp(kWhite[i], end[i], t)));
  }
  return fmt::format("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]);
}

std::map<int, Lines> TrianglesByShade(std::span<const Triangle> triangles,
                                      std::span<const std::array<double, 2>> singular_values,
                                      double range) {
  std::map<int, Lines> by_shade;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const double strain = StrainOf(singular_values, t);
    const double share = std::isfinite(strain) ? std::clamp(strain / range, -1.0, 1.0) : 1.0;
    by_shade[static_cast<int>(std::lround(share * kStrainShades))].emplace_back(
        triangles[t].begin(), triangles[t].end());
  }
  return by_shade;
}

}  // namespace arap
