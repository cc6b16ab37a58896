#include "core/drawing/comparison.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "core/base/plane.h"
#include "core/drawing/svg.h"

namespace arap {
namespace {

using Vector = Point3;

double Dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector Cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
// `fallback` for a vector without a direction.
Vector Unit(const Vector& a, const Vector& fallback) {
  const double length = std::sqrt(Dot(a, a));
  if (!(length > 1e-12)) return fallback;
  return {a[0] / length, a[1] / length, a[2] / length};
}

// Twice the area along the normal.
Vector TwiceArea(const std::array<Vector, 3>& p) {
  Vector a{}, b{};
  for (std::size_t i = 0; i < 3; ++i) {
    a[i] = p[1][i] - p[0][i];
    b[i] = p[2][i] - p[0][i];
  }
  return Cross(a, b);
}
Vector Normal(const SurfaceMesh& mesh, const Triangle& t) {
  return TwiceArea({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]});
}

// A corner of a piece of a triangle: where in the plane of the squares, where in the picture.
struct Corner {
  Complex uv;
  Complex seen;
};
using Polygon = std::vector<Corner>;

// What lies where `inside` (linear in uv) is not negative.
template <class Inside>
Polygon Clip(const Polygon& polygon, Inside inside) {
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Corner &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double at_a = inside(a.uv), at_b = inside(b.uv);
    if (at_a >= 0) kept.push_back(a);
    if ((at_a < 0) != (at_b < 0)) {
      const double t = at_a / (at_a - at_b);
      kept.push_back({a.uv + t * (b.uv - a.uv), a.seen + t * (b.seen - a.seen)});
    }
  }
  return kept;
}

// Of a convex polygon, in squares; turned over or not.
double Area(const Polygon& polygon) {
  double twice = 0;
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    const Complex a = polygon[i - 1].uv - polygon[0].uv, b = polygon[i].uv - polygon[0].uv;
    twice += (std::conj(a) * b).imag();
  }
  return std::abs(twice) / 2;
}

// The rows of squares between two numbers, by their lower ends; none when there are too many, or
// when the numbers are so large that rows cannot be told apart.
std::vector<double> Rows(double low, double high) {
  constexpr double kMostSquares = 200;  // across a triangle; finer ones would be a grey anyway
  constexpr double kFarthest = 1e9;
  std::vector<double> rows;
  if (!(high - low < kMostSquares && std::abs(low) < kFarthest)) return rows;
  for (double row = std::floor(low); row < high; ++row) rows.push_back(row);
  return rows;
}

// The parts of a triangle in dark squares.
std::vector<Polygon> DarkParts(const Polygon& triangle) {
  constexpr double kSpeck = 1e-6;  // of a square: nobody would see it
  const auto rows_of = [](const Polygon& polygon, auto coordinate) {
    double low = INFINITY, high = -INFINITY;
    for (const Corner& c : polygon) {
      low = std::min(low, coordinate(c.uv));
      high = std::max(high, coordinate(c.uv));
    }
    return Rows(low, high);
  };
  std::vector<Polygon> parts;
  for (const double u : rows_of(triangle, [](Complex p) { return p.real(); })) {
    const Polygon column = Clip(Clip(triangle, [u](Complex p) { return p.real() - u; }),
                                [u](Complex p) { return u + 1 - p.real(); });
    for (const double v : rows_of(column, [](Complex p) { return p.imag(); })) {
      if (std::fmod(std::abs(u + v), 2) != 0) continue;
      Polygon part = Clip(Clip(column, [v](Complex p) { return p.imag() - v; }),
                          [v](Complex p) { return v + 1 - p.imag(); });
      if (Area(part) > kSpeck) parts.push_back(std::move(part));
    }
  }
  return parts;
}

std::string PolygonData(const Polygon& polygon, const View& view) {
  std::vector<Complex> points;
  for (const Corner& corner : polygon) points.push_back(corner.seen);
  return PathData(points, /*closed=*/true, view);
}

// The unit normal of a triangle in the picture: right, up, towards the eye.
Vector NormalSeen(const FrontView& front, const Triangle& t) {
  std::array<Vector, 3> p;
  for (std::size_t k = 0; k < 3; ++k) {
    p[k] = {front.points()[t[k]].real(), front.points()[t[k]].imag(), front.Depth(t[k])};
  }
  return Unit(TwiceArea(p), {0, 0, 1});
}

// Where the light comes from: the left, above, before.
constexpr Vector kSun{-0.45, 0.5, 0.74};

enum Tone { kBack, kLight, kDark };

std::string ColorOf(Tone tone, int shade, int shades) {
  constexpr std::array<Vector, 3> kTones{{{196, 188, 178}, {250, 243, 230}, {66, 110, 150}}};
  const double light = 0.4 + 0.6 * shade / shades;
  const Vector& c = kTones[tone];
  return fmt::format("#{:02x}{:02x}{:02x}", static_cast<int>(light * c[0]),
                     static_cast<int>(light * c[1]), static_cast<int>(light * c[2]));
}

}  // namespace

FrontView::FrontView(const SurfaceMesh& mesh) {
  Vector sum{};
  for (const Triangle& t : mesh.triangles) {
    const Vector normal = Normal(mesh, t);
    for (std::size_t i = 0; i < 3; ++i) sum[i] += normal[i];
  }
  const Vector toward = Unit(sum, {0, 0, 1});
  // Seen from above, z goes down the page.
  const Vector up_hint = std::abs(toward[1]) < 0.9 ? Vector{0, 1, 0} : Vector{0, 0, -1};
  const Vector right = Unit(Cross(up_hint, toward), {1, 0, 0});
  const Vector up = Cross(toward, right);
  for (const Vector& p : mesh.vertices) {
    points_.emplace_back(Dot(p, right), Dot(p, up));
    depths_.push_back(Dot(p, toward));
  }
}

std::string CheckeredSurface(const SurfaceMesh& mesh, const FrontView& front,
                             std::span<const Complex> uv, std::span<const Triangle> corner_uv,
                             double square, const View& view) {
  constexpr int kLayers = 16, kShades = 8;
  double nearest = -std::numeric_limits<double>::infinity(), farthest = -nearest;
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t v : t) {
      nearest = std::max(nearest, front.Depth(v));
      farthest = std::min(farthest, front.Depth(v));
    }
  }
  // One path for all that is as far, as bright and as dark: the file stays small.
  std::map<std::pair<int, std::pair<Tone, int>>, std::string> paths;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Polygon triangle;
    double depth = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[t][k], u = corner_uv[t][k];
      triangle.push_back({uv[u] / square, front.points()[v]});
      depth += front.Depth(v) / 3;
    }
    const Vector seen = NormalSeen(front, mesh.triangles[t]);
    const Tone tone = seen[2] < 0 ? kBack : kLight;
    const double share = nearest > farthest ? (depth - farthest) / (nearest - farthest) : 0;
    const int layer = static_cast<int>(share * kLayers);
    const double light = std::max(0.0, tone == kBack ? -Dot(seen, kSun) : Dot(seen, kSun));
    const int shade = static_cast<int>(std::lround(light * kShades));
    paths[{layer, {tone, shade}}] += PolygonData(triangle, view);
    if (tone == kBack) continue;
    for (const Polygon& part : DarkParts(triangle)) {
      paths[{layer, {kDark, shade}}] += PolygonData(part, view);
    }
  }
  std::string out;
  for (const auto& [key, data] : paths) {
    fmt::format_to(std::back_inserter(out), "<path fill=\"{0}\" stroke=\"{0}\" d=\"{1}\"/>\n",
                   ColorOf(key.second.first, key.second.second, kShades), data);
  }
  return out;
}

namespace {

constexpr double kLongerSide = 420;  // of the largest picture
constexpr double kGap = 30;
constexpr double kLeastWidth = 620;  // of a panel, for its text
constexpr double kLabel = 40;
constexpr double kText = 21, kLine = 29;
constexpr std::size_t kColumns = 3;
constexpr double kSquares = 14;  // across the surface

// The flat positions turned so that they lie as the surface is seen.
std::vector<Complex> Turned(const Flattening& flat, const FrontView& front) {
  std::vector<Complex> seen, laid;
  for (const Triangle& t : flat.corner_uv) {
    for (const std::uint32_t u : t) {
      seen.push_back(front.points()[flat.source[u]]);
      laid.push_back(flat.uv[u]);
    }
  }
  Complex seen_middle, laid_middle, sum;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    seen_middle += seen[i] / static_cast<double>(seen.size());
    laid_middle += laid[i] / static_cast<double>(seen.size());
  }
  for (std::size_t i = 0; i < seen.size(); ++i) {
    sum += std::conj(laid[i] - laid_middle) * (seen[i] - seen_middle);
  }
  const Complex turn = std::abs(sum) > 0 ? sum / std::abs(sum) : 1;
  std::vector<Complex> uv;
  for (const Complex p : flat.uv) uv.push_back(turn * p);
  return uv;
}

// Wider and higher on all sides, so that a view of it has the scale of every other.
Bounds Widened(const Bounds& b, double width, double height) {
  const double x = (width - b.width()) / 2, y = (height - b.height()) / 2;
  return {b.min_x - x, b.min_y - y, b.max_x + x, b.max_y + y, false};
}

std::string FlatPicture(const Flattening& flat, const std::vector<Complex>& uv, double range,
                        const View& view) {
  std::string out;
  for (const auto& [shade, lines] : TrianglesByShade(flat.corner_uv, flat.singular_values, range)) {
    fmt::format_to(std::back_inserter(out),
                   "<path fill=\"{}\" stroke=\"#8a8378\" stroke-opacity=\"0.4\" "
                   "stroke-width=\"0.5\" d=\"{}\"/>\n",
                   StrainColor(shade), PathData(lines, /*closed=*/true, uv, view));
  }
  fmt::format_to(std::back_inserter(out),
                 "<path fill=\"none\" stroke=\"#2b2622\" stroke-width=\"2\" d=\"{}\"/>\n",
                 PathData(BoundaryLines(flat.corner_uv), /*closed=*/true, uv, view));
  return out;
}

std::string Legend(double range, double left, double top) {
  constexpr double kWidth = 480, kShadeWidth = kWidth / (2 * kStrainShades + 1);
  std::string out;
  for (int shade = -kStrainShades; shade <= kStrainShades; ++shade) {
    fmt::format_to(std::back_inserter(out),
                   "<rect x=\"{:.1f}\" y=\"{:.0f}\" width=\"{:.1f}\" height=\"22\" fill=\"{}\"/>\n",
                   left + (shade + kStrainShades) * kShadeWidth, top, kShadeWidth + 0.5,
                   StrainColor(shade));
  }
  out += SvgText(left, top + 48, kText, fmt::format("-{:g} %", range));
  out += SvgText(left + kWidth / 2 - 6, top + 48, kText, "0");
  out += SvgText(left + kWidth - 66, top + 48, kText, fmt::format("+{:g} %", range));
  return out +
         SvgText(left + kWidth + 30, top + 17, kText,
                 "larger principal strain of each triangle; stronger ones have the last colour");
}

// The strain that all but one in fifty triangles of all panels stay under: a few spikes would leave
// nothing of the colours for the rest.
double CommonStrain(const std::vector<ComparisonPanel>& panels) {
  std::vector<double> strains;
  for (const ComparisonPanel& panel : panels) {
    for (const auto& [s1, s2] : panel.flat.singular_values) {
      const double strain = std::abs(PrincipalStrainPercent(s1, s2));
      if (std::isfinite(strain) && s1 > 0) strains.push_back(strain);
    }
  }
  if (strains.empty()) return 0;
  const auto at = strains.begin() + static_cast<std::ptrdiff_t>(strains.size() * 49 / 50);
  std::nth_element(strains.begin(), at, strains.end());
  return *at;
}

}  // namespace

std::string FormatComparison(const SurfaceMesh& mesh, const std::vector<ComparisonPanel>& panels,
                             const std::string& caption) {
  const FrontView front(mesh);
  const Bounds seen = BoundsOf(front.points(), mesh.triangles);
  double width = seen.width(), height = seen.height();
  std::vector<std::vector<Complex>> layouts;
  std::size_t most_lines = 0;
  for (const ComparisonPanel& panel : panels) {
    layouts.push_back(Turned(panel.flat, front));
    const Bounds bounds = BoundsOf(layouts.back(), panel.flat.corner_uv);
    width = std::max(width, bounds.width());
    height = std::max(height, bounds.height());
    most_lines = std::max(most_lines, panel.lines.size());
  }
  const double scale = kLongerSide / std::max({width, height, 1e-300});
  const double box_width = scale * width, box_height = scale * height;
  const double panel_width = std::max(2 * box_width + kGap, kLeastWidth);
  const double panel_height =
      kLabel + box_height + kLine * (static_cast<double>(most_lines) + 1) + kGap;
  const double square = std::max(seen.width(), seen.height()) / kSquares;
  const double range = StrainRange(CommonStrain(panels));

  std::string body;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const ComparisonPanel& panel = panels[i];
    const std::size_t row = i / kColumns;
    const double left = kGap + static_cast<double>(i % kColumns) * (panel_width + 2 * kGap);
    const double top = kGap + static_cast<double>(row) * panel_height;
    body += SvgText(left, top + 26, 28, panel.label);
    if (!panel.flat.uv.empty()) {
      const View surface(Widened(seen, width, height), left, top + kLabel, box_width, box_height);
      body += CheckeredSurface(mesh, front, layouts[i], panel.flat.corner_uv, square, surface);
      const Bounds bounds = BoundsOf(layouts[i], panel.flat.corner_uv);
      const View plane(Widened(bounds, width, height), left + box_width + kGap, top + kLabel,
                       box_width, box_height);
      body += FlatPicture(panel.flat, layouts[i], range, plane);
    }
    double y = top + kLabel + box_height + kLine;
    for (const std::string& line : panel.lines) {
      body += SvgText(left, y, kText, line);
      y += kLine;
    }
  }
  const auto columns = static_cast<double>(std::min(kColumns, panels.size()));
  const auto rows = static_cast<double>((panels.size() + kColumns - 1) / kColumns);
  const double bottom = kGap + rows * panel_height;
  body += Legend(range, kGap, bottom);
  body += SvgText(kGap, bottom + 94, kText, caption);
  return SvgDocument(kGap + columns * (panel_width + 2 * kGap) - kGap, bottom + 116, body);
}

}  // namespace arap
