#include "core/drawing/pdf.h"

#include <array>
#include <cstddef>
#include <memory>
#include <string_view>

#include <fmt/format.h>
#include <hpdf.h>

namespace arap {
namespace {

constexpr double kPointsPerMillimetre = 72 / 25.4;

HPDF_REAL Points(double millimetres) {
  return static_cast<HPDF_REAL>(kPointsPerMillimetre * millimetres);
}

struct Free {
  void operator()(HPDF_Doc document) const { HPDF_Free(document); }
};
using Document = std::unique_ptr<std::remove_pointer_t<HPDF_Doc>, Free>;

// UTF-8 as Latin-1.
std::string Latin(std::string_view text) {
  std::string latin;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if (byte < 0x80) {
      latin += text[i];
    } else if ((byte == 0xc2 || byte == 0xc3) && i + 1 < text.size()) {
      const auto next = static_cast<unsigned char>(text[++i]);
      latin += static_cast<char>((byte == 0xc3 ? 0xc0 : 0x80) | (next & 0x3f));
    } else if (byte >= 0xc0) {
      latin += '?';  // what follows of the character has no sign of its own
    }
  }
  return latin;
}

void Draw(HPDF_Page out, const PageLine& line) {
  if (line.points.size() < 2) return;
  const auto part = [&](int shift) {
    return static_cast<HPDF_REAL>((line.ink.rgb >> shift & 0xff) / 255.0);
  };
  HPDF_Page_SetRGBStroke(out, part(16), part(8), part(0));
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
  for (const PageLine& line : page.drawing) Draw(out, line);
  HPDF_Page_GRestore(out);
  for (const PageLine& line : page.lines) Draw(out, line);
  HPDF_Page_BeginText(out);
  for (const PageText& text : page.texts) {
    HPDF_Page_SetFontAndSize(out, font, Points(text.size));
    HPDF_Page_TextOut(out, Points(text.at.real()), Points(text.at.imag()),
                      Latin(text.text).c_str());
  }
  HPDF_Page_EndText(out);
}

}  // namespace

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
