#include "core/drawing/svg/document.h"

#include <fmt/format.h>

namespace arap::cli {

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

std::string SvgText(double x, double y, double size, std::string_view text) {
  return fmt::format(
      R"(<text x="{:.0f}" y="{:.0f}" font-family="sans-serif" font-size="{:.0f}" fill="#4a4038">{}</text>)"
      "\n",
      x, y, size, SvgEscaped(text));
}

}  // namespace arap::cli
