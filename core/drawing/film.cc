#include "core/drawing/film.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/drawing/svg.h"

namespace arap {
namespace {

constexpr double kSize = 1000;  // the longer side of the picture part of an animation
constexpr double kMargin = 40;
constexpr double kCaption = 60;
// About five bytes for each edge of each frame: beyond this the inner edges are left out.
constexpr std::size_t kMostEdgesInAllFrames = 1'000'000;
constexpr long kHandleRadius = 11;

std::string Animate(const char* attribute, double seconds, const std::string& values) {
  return fmt::format(
      R"(<animate attributeName="{}" dur="{:.2f}s" repeatCount="indefinite" values="{}"/>)",
      attribute, seconds, values);
}

// A path that takes the place of the same lines in every frame.
std::string MovingPath(const Film& film, const Lines& lines, bool closed, const View& view,
                       std::string_view style, double seconds) {
  std::string values;
  for (const std::vector<Complex>& shape : film.shapes) {
    if (!values.empty()) values += ';';
    values += PathData(lines, closed, shape, view);
  }
  return fmt::format("<path {} d=\"{}\">{}</path>\n", style,
                     PathData(lines, closed, film.shapes.front(), view),
                     Animate("d", seconds, values));
}

// The places of a handle over the frames. While it is not there, it keeps its last place, at first
// the one where it will appear, and has no size.
struct HandlePath {
  std::vector<long> xs, ys, radii;

  HandlePath(const Film& film, std::size_t k, const View& view) {
    const auto there = [k](const std::vector<Complex>& handles) {
      return std::isfinite(handles[k].real());
    };
    const auto first = std::find_if(film.handles.begin(), film.handles.end(), there);
    if (first == film.handles.end()) return;
    Complex shown = (*first)[k];
    for (const std::vector<Complex>& handles : film.handles) {
      if (there(handles)) shown = handles[k];
      xs.push_back(view.X(shown.real()));
      ys.push_back(view.Y(shown.imag()));
      radii.push_back(there(handles) ? kHandleRadius : 0);
    }
  }
};

std::string MovingHandles(const Film& film, const View& view, double seconds) {
  std::string out;
  for (std::size_t k = 0; k < film.handles.front().size(); ++k) {
    const HandlePath path(film, k, view);
    if (path.xs.empty()) continue;
    const auto animate = [&](const char* attribute, const std::vector<long>& values) {
      return Animate(attribute, seconds, fmt::format("{}", fmt::join(values, ";")));
    };
    const bool always = *std::min_element(path.radii.begin(), path.radii.end()) > 0;
    fmt::format_to(std::back_inserter(out),
                   "<circle {} r=\"{}\" cx=\"{}\" cy=\"{}\">{}{}{}</circle>\n", kHandleStyle,
                   path.radii.front(), path.xs.front(), path.ys.front(), animate("cx", path.xs),
                   animate("cy", path.ys), always ? "" : animate("r", path.radii));
  }
  return out;
}

}  // namespace

std::string FormatAnimation(const Film& film, double seconds, const Bounds& bounds) {
  const double longer = std::max({bounds.width(), bounds.height(), 1e-300});
  const double width = kSize * bounds.width() / longer + 2 * kMargin;
  const double height = kSize * bounds.height() / longer + 2 * kMargin;
  const View view(bounds, kMargin, kMargin, width - 2 * kMargin, height - 2 * kMargin);

  std::string body =
      MovingPath(film, BoundaryLines(film.triangles), /*closed=*/true, view, kBodyStyle, seconds);
  const std::size_t edges = 3 * film.triangles.size() / 2;
  if (edges * film.frame_count() <= kMostEdgesInAllFrames) {
    body +=
        MovingPath(film, InnerLines(film.triangles), /*closed=*/false, view, kMeshStyle, seconds);
  }
  body += MovingHandles(film, view, seconds);
  // A letter is about half as wide as it is high: a long caption gets smaller letters.
  const double letters = static_cast<double>(std::max<std::size_t>(film.caption.size(), 1));
  const double size = std::min(22.0, (width - 2 * kMargin) / (0.55 * letters));
  body += SvgText(kMargin, height + kCaption / 3, size, film.caption);
  return SvgDocument(width, height + kCaption, body);
}

namespace {

constexpr double kPictureSide = 400;  // the longer one of each picture of a sheet
constexpr double kGap = 24;
constexpr double kLabel = 26;
constexpr double kSheetCaption = 44;
constexpr std::size_t kColumns = 4;

void AppendHandles(const std::vector<Complex>& handles, const View& view, std::string& out) {
  for (const Complex p : handles) {
    if (!std::isfinite(p.real())) continue;
    fmt::format_to(std::back_inserter(out), "<circle {} r=\"7\" cx=\"{}\" cy=\"{}\"/>\n",
                   kHandleStyle, view.X(p.real()), view.Y(p.imag()));
  }
}

}  // namespace

std::string FormatSheet(const Film& film) {
  const std::size_t count = film.frame_count();
  Bounds bounds;
  for (const std::vector<Complex>& shape : film.shapes) bounds.Add(shape);
  for (const std::vector<Complex>& handles : film.handles) bounds.Add(handles);
  const double longer = std::max({bounds.width(), bounds.height(), 1e-300});
  const double width = kPictureSide * bounds.width() / longer;
  const double height = kPictureSide * bounds.height() / longer;
  const std::size_t columns = std::min(kColumns, count);
  const std::size_t rows = (count + columns - 1) / columns;

  const Lines outline = BoundaryLines(film.triangles);
  const Lines inner = InnerLines(film.triangles);
  std::string body;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t row = i / columns;
    const double left = kGap + static_cast<double>(i - row * columns) * (width + kGap);
    const double top = kGap + static_cast<double>(row) * (height + kLabel + kGap);
    const View view(bounds, left, top, width, height);
    const std::vector<Complex>& shape = film.shapes[i];
    fmt::format_to(std::back_inserter(body), "<path {} d=\"{}\"/>\n<path {} d=\"{}\"/>\n",
                   kBodyStyle, PathData(outline, /*closed=*/true, shape, view), kMeshStyle,
                   PathData(inner, /*closed=*/false, shape, view));
    AppendHandles(film.handles[i], view, body);
    body +=
        SvgText(left, top + height + kLabel, 16,
                film.labels.empty() ? fmt::format("frame {}", film.numbers[i]) : film.labels[i]);
  }
  const double total_width = kGap + static_cast<double>(columns) * (width + kGap);
  const double total_height = kGap + static_cast<double>(rows) * (height + kLabel + kGap);
  body += SvgText(kGap, total_height + kSheetCaption / 2, 16, film.caption);
  return SvgDocument(total_width, total_height + kSheetCaption, body);
}

}  // namespace arap
