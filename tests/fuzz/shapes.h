// Small meshes from bytes: mostly well formed, so that more than the validation is reached.
#pragma once

#include <vector>

#include "arap/model/energy.h"
#include "arap/model/mesh.h"
#include "tests/fuzz/bytes.h"

namespace arap::fuzz {

// A grid with moved vertices, several of them, or triangles at random; then a few of its numbers
// and indices replaced. At most about a hundred triangles.
PlanarMesh PlanarFrom(Bytes& bytes);
// The same in space, also closed: a tetrahedron, a torus of few triangles, a Moebius band.
SurfaceMesh SurfaceFrom(Bytes& bytes);

// Any basis and weights; a rigidity for each triangle now and then, with a wrong length now and
// then.
EnergyOptions EnergyFrom(Bytes& bytes, std::size_t triangles);

}  // namespace arap::fuzz
