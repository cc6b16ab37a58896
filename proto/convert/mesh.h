// Meshes, energy options and what is said about them, between the model and the wire. Only what the
// model has no form for is checked here; the rest is for the core to judge.
#pragma once

#include <cstddef>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/energy.h"
#include "arap/model/mesh.h"
#include "arap/model/outline.h"
#include "arap/model/repair.h"

namespace google::protobuf {
template <typename T>
class RepeatedPtrField;
}
namespace arap::v1 {
class EnergyOptions;
class MeshInfo;
class MeshOutlineRequest;
class MeshOutlineResponse;
class Outline;
class PlanarMesh;
class RepairOptions;
class SurfaceMesh;
class Warning;
}  // namespace arap::v1

namespace arap::convert {

// Faults: kArrayLength with the field, and kMeshTooLarge before anything is copied.
Result<PlanarMesh> FromWire(const v1::PlanarMesh& mesh, const MeshLimits& limits);
Result<SurfaceMesh> FromWire(const v1::SurfaceMesh& mesh, const MeshLimits& limits);
void ToWire(const PlanarMesh& mesh, v1::PlanarMesh* out);
void ToWire(const SurfaceMesh& mesh, v1::SurfaceMesh* out);

// Faults: kArrayLength with the field, and kMeshTooLarge before anything is copied.
Result<std::vector<Outline>> FromWire(
    const google::protobuf::RepeatedPtrField<v1::Outline>& outlines, std::size_t max_points);
void ToWire(const std::vector<Outline>& outlines,
            google::protobuf::RepeatedPtrField<v1::Outline>* out);
// Numbers are for the core to judge.
OutlineOptions OptionsFromWire(const v1::MeshOutlineRequest& request);
void ToWire(const OutlineOptions& options, v1::MeshOutlineRequest* out);
void ToWire(const QualityMesh& mesh, v1::MeshOutlineResponse* out);

// `defaults` stands for what is not specified. kInvalidOption for a value that this version does
// not know.
Result<EnergyOptions> FromWire(const v1::EnergyOptions& energy, EnergyOptions defaults);
void ToWire(const EnergyOptions& energy, v1::EnergyOptions* out);

// Numbers are for the core to judge.
RepairOptions FromWire(const v1::RepairOptions& repair);
void ToWire(const RepairOptions& repair, v1::RepairOptions* out);

std::vector<Warning> FromWire(const google::protobuf::RepeatedPtrField<v1::Warning>& warnings);
void ToWire(const std::vector<Warning>& warnings,
            google::protobuf::RepeatedPtrField<v1::Warning>* out);

// The wire has no clamped_weights; a warning tells of them.
RegistrationReport ReportFromWire(const v1::MeshInfo& mesh);
void ToWire(const RegistrationReport& report, v1::MeshInfo* out);

}  // namespace arap::convert
