// Surfaces made in code. The developable ones are bent along straight rulings only and every
// triangle lies between two neighbouring rulings, so that they are isometric to the plane up to
// rounding.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/mesh/mesh.h"

namespace arap::testing {

// A surface with its true flat positions (#V); triangles are counter-clockwise in the plane.
struct Developable {
  SurfaceMesh surface;
  std::vector<Complex> flat;
};

// A width × height sheet of nx × ny cells rolled up by `turns` full turns; may run through itself.
Developable RolledSheet(std::size_t nx, std::size_t ny, double width, double height, double turns,
                        std::uint64_t seed);

// A width × height sheet folded to and fro by `fold` radians at every one of its nx − 1 inner
// rulings.
Developable Accordion(std::size_t nx, std::size_t ny, double width, double height, double fold,
                      std::uint64_t seed);

// Part of a cone between two distances from the apex: `flat_angle` radians wide in the plane, wound
// by `space_angle` > flat_angle in space; both below 2π.
Developable ConePatch(std::size_t sectors, std::size_t rings, double inner, double outer,
                      double flat_angle, double space_angle, std::uint64_t seed);

// A cap of the unit sphere around the north pole down to `polar_angle` radians: not developable.
SurfaceMesh SphereCap(std::size_t rings, std::size_t sectors, double polar_angle);

}  // namespace arap::testing
