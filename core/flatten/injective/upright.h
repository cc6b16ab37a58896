// Whether a layout is injective around every point: no triangle flipped, no vertex wound twice.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "arap/model/mesh.h"

namespace arap {

// Counter-clockwise by more than the rounding of its corners' coordinates, so that the sign of the
// area is certain and stays when the layout is scaled. False when a coordinate is not finite.
bool Upright(Complex a, Complex b, Complex c);

// Triangles that are not upright, ascending; those in the mask `left_out` (#F or empty) do not
// count.
std::vector<std::uint32_t> NotUpright(std::span<const Triangle> triangles,
                                      std::span<const Complex> uv,
                                      const std::vector<bool>& left_out = {});

// Inner vertices whose upright triangles go round them more than once (a branch point of the map),
// ascending. `boundary` (#V) marks the vertices that are not inner. Needs a layout whose triangles
// are all upright; nothing is decided at vertices of triangles left out.
std::vector<std::uint32_t> WoundTwice(std::span<const Triangle> triangles,
                                      std::span<const Complex> uv,
                                      const std::vector<bool>& boundary,
                                      const std::vector<bool>& left_out = {});

}  // namespace arap
