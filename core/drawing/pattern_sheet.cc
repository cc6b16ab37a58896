// The SVG of a pattern.
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "core/drawing/pattern_files.h"
#include "core/drawing/svg.h"

namespace arap {
namespace {

constexpr double kMargin = 10;

class SheetFrame {
 public:
  explicit SheetFrame(const Pattern& pattern)
      : bounds_(pattern.Box()), digits_(DigitsFor(pattern)) {
    const double side = std::max(bounds_.width(), bounds_.height());
    scale_ = std::max(1.0, side / 300);
    // In small pieces lines would cover what they are round.
    constexpr double kSmall = 50, kThinnest = 1e-3;
    stroke_ = side < kSmall ? std::max(side / kSmall, kThinnest) : scale_;
  }

  double width() const { return bounds_.width() + 2 * kMargin; }
  double height() const { return bounds_.height() + 2 * kMargin; }
  // Letters and lines grow with large pieces, so that an overview still shows them.
  double scale() const { return scale_; }
  double stroke() const { return stroke_; }
  int digits() const { return digits_; }

  Complex Seen(Complex p) const {
    return {p.real() - bounds_.min_x + kMargin, bounds_.max_y - p.imag() + kMargin};
  }
  std::string Place(Complex p, int digits) const {
    const Complex seen = Seen(p);
    return SvgNumber(seen.real(), digits) + " " + SvgNumber(seen.imag(), digits);
  }

  std::string Path(std::span<const Complex> points, const std::vector<std::uint32_t>& line,
                   bool closed) const {
    std::string out;
    for (const std::uint32_t u : line) {
      out += (out.empty() ? "M" : "L") + Place(points[u], digits_ - 1);
    }
    return out + (closed ? "Z" : "");
  }

  std::string Path(std::span<const Complex> line, bool closed) const {
    std::string out;
    for (const Complex p : line) out += (out.empty() ? "M" : "L") + Place(p, digits_);
    return out + (closed ? "Z" : "");
  }

 private:
  Bounds bounds_;
  int digits_;
  double scale_, stroke_;
};

std::string Group(std::string_view id, std::string_view style, const std::string& body) {
  if (body.empty()) return {};
  return fmt::format("<g id=\"{}\" {}>\n{}</g>\n", id, style, body);
}

std::string Stroke(std::string_view color, double width, std::string_view more = {}) {
  return fmt::format(R"(fill="none" stroke="{}" stroke-width="{}" stroke-linejoin="round"{})",
                     color, SvgNumber(width, 5), more);
}

std::string PathElement(const std::string& data) { return fmt::format("<path d=\"{}\"/>\n", data); }

std::string Triangles(const Pattern& pattern, double range, const SheetFrame& page) {
  std::string out;
  for (const auto& [shade, lines] :
       TrianglesByShade(pattern.triangles, pattern.singular_values, range)) {
    std::string data;
    for (const auto& line : lines) data += page.Path(pattern.points, line, /*closed=*/true);
    // The stroke closes the hairlines between neighbours.
    fmt::format_to(std::back_inserter(out), "<path fill=\"{0}\" stroke=\"{0}\" d=\"{1}\"/>\n",
                   StrainColor(shade), data);
  }
  return out;
}

// All lines of a kind.
std::string Paths(const Pattern& pattern, LineKind kind, const SheetFrame& page) {
  std::string out;
  for (const PatternPiece& piece : pattern.pieces) {
    for (const PatternLine& line : piece.lines) {
      if (line.kind != kind) continue;
      out += PathElement(page.Path(line.points, line.closed));
      if (kind != LineKind::kGrain) continue;
      out += PathElement(page.Path(ArrowHead(line, 4 * page.stroke()), /*closed=*/false));
    }
  }
  return out;
}

std::string Labels(const Pattern& pattern, bool plain, const SheetFrame& page) {
  constexpr double kRise = 0.36;  // of the height, from the middle of capitals to the base line
  std::string out;
  for (const PatternPiece& piece : pattern.pieces) {
    for (const PatternLabel& label : piece.labels) {
      if (plain && label.is_name) continue;
      const Complex at = page.Seen(label.at - Complex(0, kRise * label.height));
      fmt::format_to(std::back_inserter(out),
                     "<text x=\"{}\" y=\"{}\" font-size=\"{}\">{}</text>\n",
                     SvgNumber(at.real(), page.digits()), SvgNumber(at.imag(), page.digits()),
                     SvgNumber(label.height, 3), SvgEscaped(label.text));
    }
  }
  return out;
}

std::string Text(double x, double y, double size, std::string_view text) {
  return SvgText(x, y, size, text, 2);
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
                 Stroke("#2b2622", 0.4 * scale), SvgNumber(left, 3), SvgNumber(top, 3),
                 SvgNumber(4 * scale, 3), SvgNumber(length, 3), SvgNumber(4 * scale, 3));
  out += Text(left, below, size, fmt::format("{} mm", length));
  return out;
}

}  // namespace

std::string FormatPattern(const Pattern& pattern, const PatternSheet& sheet) {
  const SheetFrame page(pattern);
  const double s = page.scale(), stroke = page.stroke();
  const double range = StrainRange(LargestStrainPercent(pattern.singular_values));
  std::string body;
  if (sheet.strain) {
    body += Group("strain",
                  fmt::format("stroke-width=\"{}\"", SvgNumber(0.1 * std::min(1.0, stroke), 5)),
                  Triangles(pattern, range, page));
  }
  if (sheet.interior) {
    std::string inner;
    for (const auto& line : InnerLines(pattern.triangles)) {
      inner += PathElement(page.Path(pattern.points, line, /*closed=*/false));
    }
    body += Group("interior", Stroke("#8a8378", 0.15 * stroke, " stroke-opacity=\"0.6\""), inner);
  }
  const std::string allowance = Paths(pattern, LineKind::kAllowance, page);
  body += Group("allowance", Stroke("#2b2622", 0.35 * stroke), allowance);
  // Where there is an allowance, one cuts along that.
  const std::string dashed =
      allowance.empty() ? std::string()
                        : fmt::format(" stroke-dasharray=\"{} {}\"", SvgNumber(2.5 * stroke, 5),
                                      SvgNumber(1.5 * stroke, 5));
  body += Group("outline", Stroke("#2b2622", 0.5 * stroke, dashed),
                Paths(pattern, LineKind::kOutline, page));
  body +=
      Group("seam", Stroke("#c2410c", 0.6 * stroke, dashed), Paths(pattern, LineKind::kSeam, page));
  body += Group("grain", Stroke("#1d4ed8", 0.4 * stroke), Paths(pattern, LineKind::kGrain, page));

  body += Group("notch", Stroke("#2b2622", 0.35 * stroke), Paths(pattern, LineKind::kNotch, page));
  body += Group("label", "text-anchor=\"middle\" font-family=\"sans-serif\" fill=\"#2b2622\"",
                Labels(pattern, !sheet.strain, page));

  std::string ground;
  double width = page.width(), height = page.height();
  if (sheet.strain) {
    width = std::max(width, 2 * kMargin + 150 * s);
    ground = "<rect width=\"100%\" height=\"100%\" fill=\"#fbf9f5\"/>\n";
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
      "\n{2}{3}</svg>\n",
      SvgNumber(width, page.digits()), SvgNumber(height, page.digits()), ground, body);
}

}  // namespace arap
