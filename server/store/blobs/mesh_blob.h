// Mesh blobs: a planar mesh and its options as bytes, the input of a registration.
#pragma once

#include <string>
#include <string_view>

#include "arap/base/result.h"
#include "arap/model/energy.h"
#include "arap/model/mesh.h"

namespace arap::store {

struct MeshBlob {
  PlanarMesh mesh;
  EnergyOptions options;
};

// A version tag, basis, weights, then rigidity, vertices and triangles, each behind its length; all
// numbers in the byte order of the machine. Equal arguments give equal bytes.
std::string EncodeMesh(const PlanarMesh& mesh, const EnergyOptions& options);

// kDataLoss for bytes that EncodeMesh did not write.
Result<MeshBlob> DecodeMesh(std::string_view bytes);

}  // namespace arap::store
