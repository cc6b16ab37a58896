#include "core/drawing/page.h"

#include <iterator>

#include <fmt/format.h>

#include "core/drawing/svg.h"

namespace arap {
namespace {

void AppendLine(const PageLine& line, double height, int digits, std::string& out) {
  fmt::format_to(std::back_inserter(out), R"(<path stroke="#{:06x}" stroke-width="{}"{} d=")",
                 line.ink.rgb, SvgNumber(line.ink.width, 4),
                 line.ink.dashed ? R"( stroke-dasharray="2.5 1.5")" : "");
  bool first = true;
  for (const Complex p : line.points) {
    fmt::format_to(std::back_inserter(out), "{}{} {}", first ? "M" : "L",
                   SvgNumber(p.real(), digits), SvgNumber(height - p.imag(), digits));
    first = false;
  }
  out += line.closed ? "Z\"/>\n" : "\"/>\n";
}

// The stroke closes the hairlines between neighbours.
void AppendArea(const PageArea& area, double height, int digits, std::string& out) {
  fmt::format_to(std::back_inserter(out),
                 R"(<path fill="#{0:06x}" stroke="#{0:06x}" stroke-width="0.1" d=")", area.rgb);
  for (const auto& triangle : area.triangles) {
    for (const Complex p : triangle) {
      fmt::format_to(std::back_inserter(out), "{}{} {}", &p == &triangle.front() ? "M" : "L",
                     SvgNumber(p.real(), digits), SvgNumber(height - p.imag(), digits));
    }
    out += 'Z';
  }
  out += "\"/>\n";
}

}  // namespace

std::string FormatPageSvg(const Page& page, int digits) {
  std::string out = fmt::format(
      R"(<svg xmlns="http://www.w3.org/2000/svg" width="{0}mm" height="{1}mm" viewBox="0 0 {0} {1}">)"
      "\n",
      SvgNumber(page.width, digits), SvgNumber(page.height, digits));
  fmt::format_to(std::back_inserter(out),
                 R"(<clipPath id="window"><rect x="{}" y="{}" width="{}" height="{}"/></clipPath>)"
                 "\n",
                 SvgNumber(page.window.min_x, digits),
                 SvgNumber(page.height - page.window.max_y, digits),
                 SvgNumber(page.window.width(), digits), SvgNumber(page.window.height(), digits));
  out += "<g id=\"drawing\" clip-path=\"url(#window)\" fill=\"none\" stroke-linejoin=\"round\">\n";
  for (const PageArea& area : page.areas) AppendArea(area, page.height, digits, out);
  for (const PageLine& line : page.drawing) AppendLine(line, page.height, digits, out);
  out += "</g>\n<g id=\"page\" fill=\"none\">\n";
  for (const PageLine& line : page.lines) AppendLine(line, page.height, digits, out);
  out += "</g>\n";
  for (const PageText& text : page.texts) {
    fmt::format_to(
        std::back_inserter(out),
        R"(<text x="{}" y="{}" font-family="Helvetica, sans-serif" font-size="{}" fill="#2b2622">{}</text>)"
        "\n",
        SvgNumber(text.at.real(), 3), SvgNumber(page.height - text.at.imag(), 3),
        SvgNumber(text.size, 3), SvgEscaped(text.text));
  }
  return out + "</svg>\n";
}

}  // namespace arap
