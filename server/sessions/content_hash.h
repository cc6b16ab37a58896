// ContentHash: the name under which equal surfaces share what was computed from them. (That of a
// planar mesh is the name of its blob, store/mesh_blob.h.)
#pragma once

#include <string>

#include "arap/base/result.h"
#include "arap/model/flatten.h"
#include "arap/model/mesh.h"

namespace arap::app {

// SHA-256 over a version tag, the surface as it was sent and how it is cut: 64 hexadecimal digits.
// Equal arguments give equal hashes on every machine of one byte order. kInternal if the digest
// cannot be made.
Result<std::string> ContentHash(const SurfaceMesh& mesh, const CutOptions& options);

}  // namespace arap::app
