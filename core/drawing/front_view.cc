#include "core/drawing/front_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <map>
#include <utility>

#include <fmt/format.h>

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

// The parts of a triangle in dark squares.
std::vector<Polygon> DarkParts(const Polygon& triangle) {
  constexpr double kSpeck = 1e-6;       // of a square: nobody would see it
  constexpr double kMostSquares = 200;  // across a triangle; finer ones would be a grey anyway
  std::vector<Polygon> parts;
  double low_u = INFINITY, high_u = -INFINITY;
  for (const Corner& c : triangle) {
    low_u = std::min(low_u, c.uv.real());
    high_u = std::max(high_u, c.uv.real());
  }
  if (!(high_u - low_u < kMostSquares)) return parts;
  for (double u = std::floor(low_u); u < high_u; ++u) {
    const Polygon column = Clip(Clip(triangle, [u](Complex p) { return p.real() - u; }),
                                [u](Complex p) { return u + 1 - p.real(); });
    double low_v = INFINITY, high_v = -INFINITY;
    for (const Corner& c : column) {
      low_v = std::min(low_v, c.uv.imag());
      high_v = std::max(high_v, c.uv.imag());
    }
    if (!(high_v - low_v < kMostSquares)) continue;
    for (double v = std::floor(low_v); v < high_v; ++v) {
      if (std::fmod(std::abs(u + v), 2) != 0) continue;
      Polygon part = Clip(Clip(column, [v](Complex p) { return p.imag() - v; }),
                          [v](Complex p) { return v + 1 - p.imag(); });
      if (Area(part) > kSpeck) parts.push_back(std::move(part));
    }
  }
  return parts;
}

std::string PolygonData(const Polygon& polygon, const View& view) {
  std::string out;
  long x = 0, y = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const long next_x = view.X(polygon[i].seen.real());
    const long next_y = view.Y(polygon[i].seen.imag());
    const long dx = next_x - x, dy = next_y - y;
    const char* const lead = i == 0 ? "M" : i == 1 ? "l" : dx < 0 ? "" : " ";
    fmt::format_to(std::back_inserter(out), "{}{}{}{}", lead, dx, dy < 0 ? "" : " ", dy);
    x = next_x;
    y = next_y;
  }
  return out + "z";
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

}  // namespace arap
