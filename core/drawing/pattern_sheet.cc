#include "core/drawing/pattern_sheet.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "core/drawing/svg.h"

namespace arap {
namespace {

constexpr double kMargin = 10;

// Millimetres with at most three decimals and without a minus before zero.
std::string Number(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", value, decimals);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text == "-0" ? "0" : text;
}

class Page {
 public:
  explicit Page(const Pattern& pattern) {
    for (const Triangle& t : pattern.triangles) {
      for (const std::uint32_t u : t) bounds_.Add(pattern.points[u]);
    }
    for (const Ring& ring : pattern.allowance) bounds_.Add(ring);
    scale_ = std::max(1.0, std::max(bounds_.width(), bounds_.height()) / 300);
  }

  double width() const { return bounds_.width() + 2 * kMargin; }
  double height() const { return bounds_.height() + 2 * kMargin; }
  // Lines and letters grow with large pieces, so that an overview still shows them.
  double scale() const { return scale_; }

  std::string Place(Complex p, int decimals) const {
    return Number(p.real() - bounds_.min_x + kMargin, decimals) + " " +
           Number(bounds_.max_y - p.imag() + kMargin, decimals);
  }

  std::string Path(std::span<const Complex> points, const std::vector<std::uint32_t>& line,
                   bool closed, int decimals) const {
    std::string out;
    for (const std::uint32_t u : line) {
      out += (out.empty() ? "M" : "L") + Place(points[u], decimals);
    }
    return out + (closed ? "Z" : "");
  }

  std::string Path(const Ring& ring) const {
    std::string out;
    for (const Complex p : ring) out += (out.empty() ? "M" : "L") + Place(p, 3);
    return out + "Z";
  }

 private:
  Bounds bounds_;
  double scale_;
};

std::string Group(std::string_view id, std::string_view style, const std::string& body) {
  if (body.empty()) return {};
  return fmt::format("<g id=\"{}\" {}>\n{}</g>\n", id, style, body);
}

std::string Stroke(std::string_view color, double width, std::string_view more = {}) {
  return fmt::format(R"(fill="none" stroke="{}" stroke-width="{:.2f}" stroke-linejoin="round"{})",
                     color, width, more);
}

std::string PathElement(const std::string& data) { return fmt::format("<path d=\"{}\"/>\n", data); }

std::string Triangles(const Pattern& pattern, double range, const Page& page) {
  std::string out;
  for (const auto& [shade, lines] :
       TrianglesByShade(pattern.triangles, pattern.singular_values, range)) {
    std::string data;
    for (const auto& line : lines) data += page.Path(pattern.points, line, /*closed=*/true, 2);
    // The stroke closes the hairlines between neighbours.
    fmt::format_to(std::back_inserter(out), "<path fill=\"{0}\" stroke=\"{0}\" d=\"{1}\"/>\n",
                   StrainColor(shade), data);
  }
  return out;
}

std::string LinePaths(const Pattern& pattern, const Lines& lines, bool closed, int decimals,
                      const Page& page) {
  std::string out;
  for (const auto& line : lines) {
    out += PathElement(page.Path(pattern.points, line, closed, decimals));
  }
  return out;
}

// A line with an arrow head at its end.
std::string GrainArrow(const std::array<Complex, 2>& line, const Page& page) {
  const auto [a, b] = line;
  const double length = std::abs(b - a);
  const Complex back = (a - b) / length * std::min(4 * page.scale(), length / 3);
  const Complex left = b + back * std::polar(1.0, 0.4);
  const Complex right = b + back * std::polar(1.0, -0.4);
  return PathElement("M" + page.Place(a, 3) + "L" + page.Place(b, 3)) +
         PathElement("M" + page.Place(left, 3) + "L" + page.Place(b, 3) + "L" +
                     page.Place(right, 3));
}

std::string Text(double x, double y, double size, std::string_view text) {
  return fmt::format(
      R"(<text x="{:.2f}" y="{:.2f}" font-family="sans-serif" font-size="{:.2f}" fill="#4a4038">{}</text>)"
      "\n",
      x, y, size, SvgEscaped(text));
}

// The colours from −range to +range percent, and beside them a length to check a print by.
std::string Legend(double range, double top, double scale) {
  const double width = 80 * scale, shade_width = width / (2 * kStrainShades + 1);
  std::string out;
  for (int shade = -kStrainShades; shade <= kStrainShades; ++shade) {
    fmt::format_to(
        std::back_inserter(out),
        "<rect x=\"{:.3f}\" y=\"{:.2f}\" width=\"{:.3f}\" height=\"{:.2f}\" fill=\"{}\"/>\n",
        kMargin + (shade + kStrainShades) * shade_width, top, shade_width * 1.1, 4 * scale,
        StrainColor(shade));
  }
  const double below = top + 8 * scale, size = 3.4 * scale;
  out += Text(kMargin, below, size, fmt::format("-{:g} %", range));
  out += Text(kMargin + width / 2 - scale, below, size, "0");
  out += Text(kMargin + width - 9 * scale, below, size, fmt::format("+{:g} %", range));
  out += Text(kMargin, top - 1.5 * scale, size, "larger principal strain");
  const double length = scale < 2 ? 50 : 100;
  const double left = kMargin + width + 10 * scale;
  fmt::format_to(std::back_inserter(out), "<path {} d=\"M{} {}v{}h{}v-{}\"/>\n",
                 Stroke("#2b2622", 0.4 * scale), Number(left, 3), Number(top, 3),
                 Number(4 * scale, 3), Number(length, 3), Number(4 * scale, 3));
  out += Text(left, below, size, fmt::format("{} mm", length));
  return out;
}

}  // namespace

std::string FormatPattern(const Pattern& pattern, const PatternSheet& sheet) {
  const Page page(pattern);
  const double s = page.scale();
  const double range = StrainRange(LargestStrainPercent(pattern.singular_values));
  std::string body;
  if (sheet.strain) {
    body += Group("strain", "stroke-width=\"0.1\"", Triangles(pattern, range, page));
  }
  if (sheet.interior) {
    body += Group("interior", Stroke("#8a8378", 0.15 * s, " stroke-opacity=\"0.6\""),
                  LinePaths(pattern, InnerLines(pattern.triangles), /*closed=*/false, 2, page));
  }
  std::string allowance;
  for (const Ring& ring : pattern.allowance) allowance += PathElement(page.Path(ring));
  body += Group("allowance", Stroke("#2b2622", 0.35 * s), allowance);
  const std::string dashed = fmt::format(" stroke-dasharray=\"{:.2f} {:.2f}\"", 2.5 * s, 1.5 * s);
  body += Group("outline",
                Stroke("#2b2622", 0.5 * s, pattern.allowance.empty() ? std::string() : dashed),
                LinePaths(pattern, pattern.outlines, /*closed=*/true, 3, page));
  body += Group("seam", Stroke("#c2410c", 0.6 * s),
                LinePaths(pattern, pattern.seams, /*closed=*/false, 3, page));
  std::string grain;
  for (const auto& line : pattern.grain_lines) grain += GrainArrow(line, page);
  body += Group("grain", Stroke("#1d4ed8", 0.4 * s), grain);

  double width = page.width(), height = page.height();
  if (sheet.strain) {
    width = std::max(width, 2 * kMargin + 150 * s);
    const double top = height + 3 * s;
    body += Legend(range, top, s);
    height = top + 16 * s;
    for (const std::string& line : sheet.caption) {
      body += Text(kMargin, height, 3.4 * s, line);
      height += 5 * s;
    }
  }
  return fmt::format(
      R"(<svg xmlns="http://www.w3.org/2000/svg" width="{0}mm" height="{1}mm" viewBox="0 0 {0} {1}">)"
      "\n<rect width=\"100%\" height=\"100%\" fill=\"{2}\"/>\n{3}</svg>\n",
      Number(width, 3), Number(height, 3), sheet.strain ? "#fbf9f5" : "#ffffff", body);
}

}  // namespace arap
