// The contact sheet.
#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "core/drawing/svg/animation.h"
#include "core/drawing/svg/document.h"
#include "core/drawing/svg/mesh_lines.h"
#include "core/drawing/svg/view.h"

namespace arap::cli {
namespace {

constexpr double kLongerSide = 400;  // of one picture
constexpr double kGap = 24;
constexpr double kLabel = 26;
constexpr double kCaption = 44;
constexpr std::size_t kColumns = 4;

void AppendHandles(const std::vector<double>& handles, const View& view, std::string& out) {
  for (std::size_t k = 0; k + 1 < handles.size(); k += 2) {
    if (!std::isfinite(handles[k])) continue;
    fmt::format_to(std::back_inserter(out), "<circle {} r=\"7\" cx=\"{}\" cy=\"{}\"/>\n",
                   kHandleStyle, view.X(handles[k]), view.Y(handles[k + 1]));
  }
}

}  // namespace

std::vector<std::size_t> Spread(std::size_t total, std::size_t count) {
  std::vector<std::size_t> chosen;
  if (total == 0 || count == 0) return chosen;
  if (count == 1) return {0};
  count = std::min(total, count);
  for (std::size_t i = 0; i < count; ++i) {
    chosen.push_back(count == 1 ? 0 : i * (total - 1) / (count - 1));
  }
  return chosen;
}

std::string FormatSheet(const Film& film, std::size_t count) {
  const std::vector<std::size_t> chosen = Spread(film.frame_count(), count);
  Bounds bounds;
  for (const std::size_t frame : chosen) {
    bounds.Add(film.shapes[frame]);
    bounds.Add(film.handles[frame]);
  }
  const double longer = std::max({bounds.width(), bounds.height(), 1e-300});
  const double width = kLongerSide * bounds.width() / longer;
  const double height = kLongerSide * bounds.height() / longer;
  const std::size_t columns = std::min(kColumns, chosen.size());
  const std::size_t rows = (chosen.size() + columns - 1) / columns;

  const Lines outline = BoundaryLines(film.triangles);
  const Lines inner = InnerLines(film.triangles);
  std::string body;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const std::size_t row = i / columns;
    const double left = kGap + static_cast<double>(i - row * columns) * (width + kGap);
    const double top = kGap + static_cast<double>(row) * (height + kLabel + kGap);
    const View view(bounds, left, top, width, height);
    const std::vector<double>& shape = film.shapes[chosen[i]];
    fmt::format_to(std::back_inserter(body), "<path {} d=\"{}\"/>\n<path {} d=\"{}\"/>\n",
                   kBodyStyle, PathData(outline, /*closed=*/true, shape, view), kMeshStyle,
                   PathData(inner, /*closed=*/false, shape, view));
    AppendHandles(film.handles[chosen[i]], view, body);
    const std::size_t frame = chosen[i];
    body += SvgText(
        left, top + height + kLabel, 16,
        film.labels.empty() ? fmt::format("frame {}", film.numbers[frame]) : film.labels[frame]);
  }
  const double total_width = kGap + static_cast<double>(columns) * (width + kGap);
  const double total_height = kGap + static_cast<double>(rows) * (height + kLabel + kGap);
  body += SvgText(kGap, total_height + kCaption / 2, 16, film.caption);
  return SvgDocument(total_width, total_height + kCaption, body);
}

}  // namespace arap::cli
