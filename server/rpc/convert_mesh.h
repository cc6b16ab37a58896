// Meshes and energy options between the wire and the core.
#pragma once

#include <string>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/energy.h"
#include "arap/model/mesh.h"
#include "core/mesh/validation.h"

namespace google::protobuf {
template <typename T>
class RepeatedPtrField;
}
namespace arap::v1 {
class EnergyOptions;
class MeshInfo;
class PlanarMesh;
class SurfaceMesh;
class Warning;
}  // namespace arap::v1
namespace arap::app {
struct MeshEntry;
}

namespace arap::rpc {

// Copy the arrays; what they say is for the core to judge. Faults: kArrayLength with the field, and
// kMeshTooLarge before anything is copied.
Result<PlanarMesh> FromWire(const v1::PlanarMesh& mesh, const MeshLimits& limits);
Result<SurfaceMesh> FromWire(const v1::SurfaceMesh& mesh, const MeshLimits& limits);

// `default_weights` stands for EDGE_WEIGHTS_UNSPECIFIED. kInvalidOption for a value that this
// version does not know, kArrayLength for a rigidity that is neither empty nor one per triangle.
Result<EnergyOptions> FromWire(const v1::EnergyOptions& options, Weights default_weights,
                               std::size_t triangles);

// kInvalidOption for a value of an enumeration that this version does not know.
Fault UnknownValue(const char* field, int value);

void ToWire(const std::vector<Warning>& warnings,
            google::protobuf::RepeatedPtrField<v1::Warning>* out);
// Without the rigidity array, which only the client needs and has.
void ToWire(const app::MeshEntry& entry, v1::MeshInfo* out);

}  // namespace arap::rpc
