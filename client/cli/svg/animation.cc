#include "client/cli/svg/animation.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "client/cli/svg/document.h"
#include "client/cli/svg/mesh_lines.h"
#include "client/cli/svg/view.h"

namespace arap::cli {
namespace {

constexpr double kSize = 1000;  // the longer side of the picture part
constexpr double kMargin = 40;
constexpr double kCaption = 60;
constexpr std::size_t kMostFrames = 90;
// About five bytes for each edge of each frame: beyond this the inner edges are left out.
constexpr std::size_t kMostEdgesInAllFrames = 1'000'000;
constexpr double kFramesPerSecond = 30;

Bounds BoundsOf(const Film& film) {
  Bounds bounds;
  for (const auto& shape : film.shapes) bounds.Add(shape);
  for (const auto& handles : film.handles) bounds.Add(handles);
  return bounds;
}

std::string Animate(const char* attribute, double seconds, const std::string& values) {
  return fmt::format(
      R"(<animate attributeName="{}" dur="{:.2f}s" repeatCount="indefinite" values="{}"/>)",
      attribute, seconds, values);
}

// A path that takes the place of the same lines in every chosen frame.
std::string MovingPath(const Film& film, const std::vector<std::size_t>& chosen, const Lines& lines,
                       bool closed, const View& view, std::string_view style, double seconds) {
  std::string values;
  for (const std::size_t frame : chosen) {
    if (!values.empty()) values += ';';
    values += PathData(lines, closed, film.shapes[frame], view);
  }
  return fmt::format("<path {} d=\"{}\">{}</path>\n", style,
                     PathData(lines, closed, film.shapes[chosen.front()], view),
                     Animate("d", seconds, values));
}

std::string MovingHandles(const Film& film, const std::vector<std::size_t>& chosen,
                          const View& view, double seconds) {
  std::string out;
  for (std::size_t k = 0; k + 1 < film.handles.front().size(); k += 2) {
    std::string xs, ys;
    for (const std::size_t frame : chosen) {
      const char* const lead = xs.empty() ? "" : ";";
      fmt::format_to(std::back_inserter(xs), "{}{}", lead, view.X(film.handles[frame][k]));
      fmt::format_to(std::back_inserter(ys), "{}{}", lead, view.Y(film.handles[frame][k + 1]));
    }
    fmt::format_to(std::back_inserter(out),
                   "<circle {} r=\"11\" cx=\"{}\" cy=\"{}\">{}{}</circle>\n", kHandleStyle,
                   view.X(film.handles[chosen.front()][k]),
                   view.Y(film.handles[chosen.front()][k + 1]), Animate("cx", seconds, xs),
                   Animate("cy", seconds, ys));
  }
  return out;
}

// How many frames an animation keeps: every frame, every second, every third… of the film, so that
// the time between two of them is the same throughout.
std::vector<std::size_t> Thinned(std::size_t total) {
  const std::size_t step = (total + kMostFrames - 1) / kMostFrames;
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < total; i += step) chosen.push_back(i);
  return chosen;
}

}  // namespace

std::string FormatAnimation(const Film& film) {
  const Bounds bounds = BoundsOf(film);
  const double longer = std::max({bounds.width(), bounds.height(), 1e-300});
  const double width = kSize * bounds.width() / longer + 2 * kMargin;
  const double height = kSize * bounds.height() / longer + 2 * kMargin;
  const View view(bounds, kMargin, kMargin, width - 2 * kMargin, height - 2 * kMargin);
  const std::vector<std::size_t> chosen = Thinned(film.frame_count());
  const double seconds = std::max(1.0, static_cast<double>(film.frame_count()) / kFramesPerSecond);

  std::string body = MovingPath(film, chosen, BoundaryLines(film.triangles), /*closed=*/true, view,
                                kBodyStyle, seconds);
  const std::size_t edges = film.triangles.size() / 2;
  if (edges * chosen.size() <= kMostEdgesInAllFrames) {
    body += MovingPath(film, chosen, InnerLines(film.triangles), /*closed=*/false, view, kMeshStyle,
                       seconds);
  }
  body += MovingHandles(film, chosen, view, seconds);
  // A letter is about half as wide as it is high: a long caption gets smaller letters.
  const double letters = static_cast<double>(std::max<std::size_t>(film.caption.size(), 1));
  const double size = std::min(22.0, (width - 2 * kMargin) / (0.55 * letters));
  body += SvgText(kMargin, height + kCaption / 3, size, film.caption);
  return SvgDocument(width, height + kCaption, body);
}

}  // namespace arap::cli
