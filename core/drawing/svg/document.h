// The frame of an SVG file and the small things in it.
#pragma once

#include <string>
#include <string_view>

namespace arap::cli {

// The whole file: a view box from the origin, a light ground, then `body`.
std::string SvgDocument(double width, double height, std::string_view body);

// With everything replaced that XML gives a meaning.
std::string SvgEscaped(std::string_view text);

// One line of text; `x`, `y` is the left end of its base line. Escapes what XML wants escaped.
std::string SvgText(double x, double y, double size, std::string_view text);

inline constexpr std::string_view kBodyStyle =
    R"(fill="#f2b56b" stroke="#7a4a1d" stroke-width="4" stroke-linejoin="round")";
inline constexpr std::string_view kMeshStyle =
    R"(fill="none" stroke="#9a6530" stroke-opacity="0.45" stroke-width="1" stroke-linejoin="round")";
inline constexpr std::string_view kHandleStyle =
    R"(fill="#2d6cdf" stroke="#ffffff" stroke-width="3")";

}  // namespace arap::cli
