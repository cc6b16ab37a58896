#include "client/src/convert.h"

namespace arap::client::internal {
namespace {

v1::Basis ToWire(Basis basis) {
  switch (basis) {
    case Basis::kDefault:
      return v1::BASIS_UNSPECIFIED;
    case Basis::kEdge:
      return v1::BASIS_EDGE;
    case Basis::kEdgeAsPublished:
      return v1::BASIS_EDGE_AS_PUBLISHED;
    case Basis::kFace:
      return v1::BASIS_FACE;
    case Basis::kVertex:
      return v1::BASIS_VERTEX;
  }
  return v1::BASIS_UNSPECIFIED;
}

Basis FromWire(v1::Basis basis) {
  switch (basis) {
    case v1::BASIS_EDGE:
      return Basis::kEdge;
    case v1::BASIS_EDGE_AS_PUBLISHED:
      return Basis::kEdgeAsPublished;
    case v1::BASIS_FACE:
      return Basis::kFace;
    case v1::BASIS_VERTEX:
      return Basis::kVertex;
    default:
      return Basis::kDefault;
  }
}

v1::EdgeWeights ToWire(EdgeWeights weights) {
  switch (weights) {
    case EdgeWeights::kDefault:
      return v1::EDGE_WEIGHTS_UNSPECIFIED;
    case EdgeWeights::kUniform:
      return v1::EDGE_WEIGHTS_UNIFORM;
    case EdgeWeights::kCotangent:
      return v1::EDGE_WEIGHTS_COTANGENT;
  }
  return v1::EDGE_WEIGHTS_UNSPECIFIED;
}

EdgeWeights FromWire(v1::EdgeWeights weights) {
  switch (weights) {
    case v1::EDGE_WEIGHTS_UNIFORM:
      return EdgeWeights::kUniform;
    case v1::EDGE_WEIGHTS_COTANGENT:
      return EdgeWeights::kCotangent;
    default:
      return EdgeWeights::kDefault;
  }
}

}  // namespace

std::chrono::nanoseconds FromWire(const google::protobuf::Duration& duration) {
  return std::chrono::seconds(duration.seconds()) + std::chrono::nanoseconds(duration.nanos());
}

double Micros(const google::protobuf::Duration& duration) {
  return std::chrono::duration<double, std::micro>(FromWire(duration)).count();
}

void ToWire(std::chrono::nanoseconds duration, google::protobuf::Duration* out) {
  const auto seconds = std::chrono::floor<std::chrono::seconds>(duration);
  out->set_seconds(seconds.count());
  out->set_nanos(static_cast<std::int32_t>((duration - seconds).count()));
}

void ToWire(const PlanarMesh& mesh, v1::PlanarMesh* out) {
  Append(std::span(mesh.vertices), out->mutable_vertices());
  Append(std::span(mesh.triangles), out->mutable_triangles());
}

void ToWire(const SurfaceMesh& mesh, v1::SurfaceMesh* out) {
  Append(std::span(mesh.vertices), out->mutable_vertices());
  Append(std::span(mesh.triangles), out->mutable_triangles());
}

void ToWire(const EnergyOptions& energy, v1::EnergyOptions* out) {
  out->set_basis(ToWire(energy.basis));
  out->set_weights(ToWire(energy.weights));
  Append(std::span(energy.rigidity), out->mutable_rigidity());
}

EnergyOptions FromWire(const v1::EnergyOptions& energy) {
  return {FromWire(energy.basis()), FromWire(energy.weights()), Values<double>(energy.rigidity())};
}

std::vector<Warning> FromWire(const google::protobuf::RepeatedPtrField<v1::Warning>& warnings) {
  std::vector<Warning> out;
  for (const v1::Warning& warning : warnings) {
    out.push_back({warning.kind(), warning.count(), Values<std::uint32_t>(warning.elements()),
                   warning.message()});
  }
  return out;
}

MeshInfo FromWire(const v1::MeshInfo& mesh) {
  MeshInfo out;
  out.id = mesh.mesh_id();
  out.content_hash = mesh.content_hash();
  out.vertex_count = mesh.vertex_count();
  out.triangle_count = mesh.triangle_count();
  out.edge_count = mesh.edge_count();
  out.component_count = mesh.component_count();
  out.boundary_loop_count = mesh.boundary_loop_count();
  out.area = mesh.area();
  out.diagonal = mesh.diagonal();
  out.warnings = FromWire(mesh.warnings());
  out.bytes = mesh.bytes();
  out.energy = FromWire(mesh.energy());
  return out;
}

}  // namespace arap::client::internal
