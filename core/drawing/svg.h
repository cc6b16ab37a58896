// What every SVG here is made of: a mesh as a few long lines, the place of the plane in the picture,
// paths, text, the frame; and strain as a colour: blue compressed, white unchanged, red stretched.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "arap/model/mesh.h"
#include "core/base/plane.h"

namespace arap {

// Vertex indices along each line: few long ones keep the picture small, and the same lines serve
// every frame of an animation.
using Lines = std::vector<std::vector<std::uint32_t>>;

// The closed boundary curves; a curve does not repeat its first vertex.
Lines BoundaryLines(std::span<const Triangle> triangles);
// Open lines that together draw every edge inside the mesh once.
Lines InnerLines(std::span<const Triangle> triangles);

// Maps the plane (y up) to whole picture units (y down).
class View {
 public:
  // Fits `bounds` into the middle of the box at `left`, `top`, keeping its proportions.
  View(const Bounds& bounds, double left, double top, double width, double height);

  long X(double x) const;
  long Y(double y) const;

 private:
  double scale_;
  double offset_x_;
  double offset_y_;
};

// The value of the attribute `d` of a path along the lines. Coordinates are whole picture units,
// relative to the point before.
std::string PathData(const Lines& lines, bool closed, std::span<const Complex> positions,
                     const View& view);

// The same along one line through `points`.
std::string PathData(std::span<const Complex> points, bool closed, const View& view);

// The whole file: a view box from the origin, a light ground, then `body`.
std::string SvgDocument(double width, double height, std::string_view body);

// A number with at most so many digits after the point, without zeros at the end and without a minus
// before 0. `digits` is 1 at least.
std::string SvgNumber(double value, int digits);

// `text` with &, <, > and " written as XML wants them.
std::string SvgEscaped(std::string_view text);

// One line of text; `x`, `y` is the left end of its base line. Escapes `text`. So many digits after
// the point.
std::string SvgText(double x, double y, double size, std::string_view text, int digits = 0);

// Attributes of what moves: the mesh, its inner edges, its handles.
inline constexpr std::string_view kBodyStyle =
    R"(fill="#f2b56b" stroke="#7a4a1d" stroke-width="4" stroke-linejoin="round")";
inline constexpr std::string_view kMeshStyle =
    R"(fill="none" stroke="#9a6530" stroke-opacity="0.45" stroke-width="1" stroke-linejoin="round")";
inline constexpr std::string_view kHandleStyle =
    R"(fill="#2d6cdf" stroke="#ffffff" stroke-width="3")";

// The strain of a triangle in percent: of the two principal strains s1 − 1 and s2 − 1 the one that
// is farther from 0. Negative is compression.
double PrincipalStrainPercent(double s1, double s2);

// The largest absolute strain over triangles with s1 and s2; those that are not finite and those
// that were left out (0 0) do not count.
double LargestStrainPercent(std::span<const std::array<double, 2>> singular_values);

// 1, 2 or 5 times a power of ten, at least `percent` and at least 1e-6: the end of a colour scale.
double StrainRange(double percent);

inline constexpr int kStrainShades = 24;  // on each side of white

// From −kStrainShades (blue) to kStrainShades (red).
std::string StrainColor(int shade);

// The triangles of each shade, as lines for a path. Without singular values all are white.
std::map<int, Lines> TrianglesByShade(std::span<const Triangle> triangles,
                                      std::span<const std::array<double, 2>> singular_values,
                                      double range);

}  // namespace arap
