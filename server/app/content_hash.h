// ContentHash: the name under which equal meshes share what was computed from them.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/cut/cut_surface.h"
#include "core/energy/options.h"
#include "core/mesh/mesh.h"

namespace arap::app {

// SHA-256 over a version tag, the mesh as it was sent and the options: 64 hexadecimal digits. Equal
// arguments give equal hashes on every machine of one byte order. kInternal if the digest cannot be
// made.
Result<std::string> ContentHash(const PlanarMesh& mesh, const EnergyOptions& options);

// The same for a surface and how it is cut; the limits do not count.
Result<std::string> ContentHash(const SurfaceMesh& mesh, const CutOptions& options);

}  // namespace arap::app
