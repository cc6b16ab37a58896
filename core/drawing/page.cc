#include "core/drawing/page.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <hpdf.h>

#include "core/base/code_point.h"
#include "core/base/names.h"
#include "core/drawing/svg.h"

namespace arap {

Result<Paper> ParsePaper(std::string_view text) {
  struct Named {
    std::string_view name;
    double width, height;
  };
  constexpr std::array<Named, 9> kNamed{{{"A0", 841, 1189},
                                         {"A1", 594, 841},
                                         {"A2", 420, 594},
                                         {"A3", 297, 420},
                                         {"A4", 210, 297},
                                         {"A5", 148, 210},
                                         {"letter", 215.9, 279.4},
                                         {"legal", 215.9, 355.6},
                                         {"tabloid", 279.4, 431.8}}};
  for (const Named& named : kNamed) {
    if (text == named.name) return Paper{named.width, named.height, true};
  }
  constexpr double kSmallest = 100;  // a square of 50 mm and what is said about it
  std::array<double, 2> sides{};
  const std::size_t cross = std::min(text.find('x'), text.size());
  const auto read = [](std::string_view number, double& side) {
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), side);
    return error == std::errc() && end == number.data() + number.size() && side >= kSmallest &&
           side <= kLargestPdfPage;
  };
  if (cross < text.size() && read(text.substr(0, cross), sides[0]) &&
      read(text.substr(cross + 1), sides[1])) {
    return Paper{sides[0], sides[1], false};
  }
  return Fail(Fault(FaultKind::kInvalidOption,
                    fmt::format("The paper {} is none of A0 to A5, letter, legal, tabloid, or "
                                "WIDTHxHEIGHT with {:.0f} to {:.0f} mm.",
                                Quote(text), kSmallest, kLargestPdfPage))
                  .Field("paper"));
}

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

namespace {

constexpr double kPointsPerMillimetre = 72 / 25.4;

HPDF_REAL Points(double millimetres) {
  return static_cast<HPDF_REAL>(kPointsPerMillimetre * millimetres);
}

struct Free {
  void operator()(HPDF_Doc document) const { HPDF_Free(document); }
};
using Document = std::unique_ptr<std::remove_pointer_t<HPDF_Doc>, Free>;

// What WinAnsiEncoding has from 0x80 to 0x9f; 0: nothing.
constexpr std::array<std::uint16_t, 32> kWindows{
    0x20ac, 0,      0x201a, 0x0192, 0x201e, 0x2026, 0x2020, 0x2021, 0x02c6, 0x2030, 0x0160,
    0x2039, 0x0152, 0,      0x017d, 0,      0,      0x2018, 0x2019, 0x201c, 0x201d, 0x2022,
    0x2013, 0x2014, 0x02dc, 0x2122, 0x0161, 0x203a, 0x0153, 0,      0x017e, 0x0178};

// The byte of a character in WinAnsiEncoding; nothing where it has none.
std::optional<char> ByteOf(const CodePoint& point) {
  if (!point.IsHarmless()) return std::nullopt;
  if (point.value < 0x100) return static_cast<char>(point.value);
  const auto found = std::find(kWindows.begin(), kWindows.end(), point.value);
  if (found == kWindows.end()) return std::nullopt;
  return static_cast<char>(0x80 + (found - kWindows.begin()));
}

std::string Encoded(std::string_view text) {
  std::string bytes;
  while (!text.empty()) {
    const CodePoint point(text);
    bytes += ByteOf(point).value_or('?');
    text.remove_prefix(point.length);
  }
  return bytes;
}

// Of red (16), green (8) or blue (0), from 0 to 1.
HPDF_REAL PartOf(std::uint32_t rgb, int shift) {
  return static_cast<HPDF_REAL>((rgb >> shift & 0xff) / 255.0);
}

void SetStroke(HPDF_Page out, std::uint32_t rgb) {
  HPDF_Page_SetRGBStroke(out, PartOf(rgb, 16), PartOf(rgb, 8), PartOf(rgb, 0));
}

void Fill(HPDF_Page out, const PageArea& area) {
  HPDF_Page_SetRGBFill(out, PartOf(area.rgb, 16), PartOf(area.rgb, 8), PartOf(area.rgb, 0));
  // The stroke closes the hairlines between neighbours.
  SetStroke(out, area.rgb);
  HPDF_Page_SetLineWidth(out, Points(0.1));
  constexpr std::size_t kTogether = 500;  // viewers are slow with long paths
  for (std::size_t i = 0; i < area.triangles.size(); ++i) {
    const auto& [a, b, c] = area.triangles[i];
    HPDF_Page_MoveTo(out, Points(a.real()), Points(a.imag()));
    HPDF_Page_LineTo(out, Points(b.real()), Points(b.imag()));
    HPDF_Page_LineTo(out, Points(c.real()), Points(c.imag()));
    HPDF_Page_ClosePath(out);
    if ((i + 1) % kTogether == 0 || i + 1 == area.triangles.size()) HPDF_Page_FillStroke(out);
  }
}

void Draw(HPDF_Page out, const PageLine& line) {
  if (line.points.size() < 2) return;
  SetStroke(out, line.ink.rgb);
  HPDF_Page_SetLineWidth(out, Points(line.ink.width));
  constexpr std::array<HPDF_UINT16, 2> kDashes{7, 4};  // points
  HPDF_Page_SetDash(out, kDashes.data(), line.ink.dashed ? 2 : 0, 0);
  bool first = true;
  for (const Complex p : line.points) {
    (first ? HPDF_Page_MoveTo : HPDF_Page_LineTo)(out, Points(p.real()), Points(p.imag()));
    first = false;
  }
  line.closed ? HPDF_Page_ClosePathStroke(out) : HPDF_Page_Stroke(out);
}

void AddPage(HPDF_Doc document, HPDF_Font font, const Page& page) {
  const HPDF_Page out = HPDF_AddPage(document);
  HPDF_Page_SetWidth(out, Points(page.width));
  HPDF_Page_SetHeight(out, Points(page.height));
  HPDF_Page_SetLineJoin(out, HPDF_ROUND_JOIN);
  HPDF_Page_GSave(out);
  HPDF_Page_Rectangle(out, Points(page.window.min_x), Points(page.window.min_y),
                      Points(page.window.width()), Points(page.window.height()));
  HPDF_Page_Clip(out);
  HPDF_Page_EndPath(out);
  for (const PageArea& area : page.areas) Fill(out, area);
  for (const PageLine& line : page.drawing) Draw(out, line);
  HPDF_Page_GRestore(out);
  for (const PageLine& line : page.lines) Draw(out, line);
  HPDF_Page_BeginText(out);
  constexpr double kSmallest =
      0.01;  // nobody sees smaller letters, and the library refuses none at all
  for (const PageText& text : page.texts) {
    if (text.size < kSmallest) continue;
    HPDF_Page_SetFontAndSize(out, font, Points(text.size));
    HPDF_Page_TextOut(out, Points(text.at.real()), Points(text.at.imag()),
                      Encoded(text.text).c_str());
  }
  HPDF_Page_EndText(out);
}

}  // namespace

bool PdfShows(std::string_view text) {
  while (!text.empty()) {
    const CodePoint point(text);
    if (!ByteOf(point)) return false;
    text.remove_prefix(point.length);
  }
  return true;
}

Result<std::string> FormatPdf(const std::vector<Page>& pages) {
  constexpr double kSmallest = 2;
  for (const Page& page : pages) {
    for (const double side : {page.width, page.height}) {
      if (side >= kSmallest && side <= kLargestPdfPage) continue;
      return Fail(Fault(FaultKind::kInvalidOption,
                        fmt::format("A page of a PDF has {:.0f} to {:.0f} mm; this one would be "
                                    "{:.1f} × {:.1f} mm.",
                                    kSmallest, kLargestPdfPage, page.width, page.height))
                      .Field("paper"));
    }
  }
  // Without a handler the first error of the document stays, and later calls do nothing.
  const Document document(HPDF_New(nullptr, nullptr));
  if (!document) return Fail(FaultKind::kOutOfMemory, "No memory for a PDF.");
  HPDF_SetCompressionMode(document.get(), HPDF_COMP_ALL);
  const HPDF_Font font = HPDF_GetFont(document.get(), "Helvetica", "WinAnsiEncoding");
  for (const Page& page : pages) AddPage(document.get(), font, page);
  HPDF_SaveToStream(document.get());
  if (const HPDF_STATUS error = HPDF_GetError(document.get()); error != HPDF_OK) {
    return Fail(Fault(FaultKind::kInternal, "The PDF could not be made.").Detail("code", error));
  }
  auto size = static_cast<HPDF_UINT32>(HPDF_GetStreamSize(document.get()));
  std::string bytes(size, '\0');
  HPDF_ReadFromStream(document.get(), reinterpret_cast<HPDF_BYTE*>(bytes.data()), &size);
  bytes.resize(size);
  return bytes;
}

}  // namespace arap
