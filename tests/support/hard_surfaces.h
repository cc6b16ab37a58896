// Surfaces that are hard to lay flat, made in code: deep, with several holes, with thin limbs, long
// and narrow. None is developable, and on most of them a descent from the first step is long. All
// are one piece with two sides and at least one boundary, oriented, without genus.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "arap/model/mesh.h"

namespace arap::testing {

// `size` is the number of cells along the longer side of what the surface is made of: vertices grow
// with its square.

// A thimble: a half ball with a wall of three times its radius.
SurfaceMesh DeepCup(std::size_t size);

// The upper half of a rounded box with eleven openings, as a car's body has.
SurfaceMesh CarBody(std::size_t size);

// Five thin arms that droop from a disk.
SurfaceMesh Starfish(std::size_t size);

// A ribbon sixty times as long as wide that turns about itself three times.
SurfaceMesh TwistedRibbon(std::size_t size);

// A ribbon sixty times as long as wide, laid in waves, with dents.
SurfaceMesh DentedRibbon(std::size_t size);

// The body of a tee: openings for neck, hem and two arms.
SurfaceMesh TeeBody(std::size_t size);

// A face: a dome with a nose, sockets for the eyes and a mouth.
SurfaceMesh Face(std::size_t size);

// Half a ball with four long fingers.
SurfaceMesh Paw(std::size_t size);

struct HardSurface {
  std::string name;
  SurfaceMesh mesh;
};

// All of them with 1,000 to 5,000 vertices.
std::vector<HardSurface> HardSurfaces();

// The body of a car, a face and a paw of 15,000 to 30,000 vertices.
std::vector<HardSurface> LargeHardSurfaces();

}  // namespace arap::testing
