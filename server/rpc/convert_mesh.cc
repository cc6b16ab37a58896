#include "server/rpc/convert_mesh.h"

#include <algorithm>

#include <arap/v1/deformation_service.pb.h>
#include <arap/v1/geometry.pb.h>
#include <fmt/format.h>

#include "server/sessions/rebuild.h"

namespace arap::rpc {
namespace {

Status CheckArray(int length, int group, const char* field, std::size_t limit, const char* quota) {
  if (length % group != 0) {
    Fault fault =
        Fault(FaultKind::kArrayLength,
              fmt::format("{} has {} numbers, not a multiple of {}.", field, length, group))
            .Field(field);
    return Fail(fault.Detail("length", std::to_string(length))
                    .Detail("expected", fmt::format("a multiple of {}", group)));
  }
  const auto count = static_cast<std::size_t>(length / group);
  if (count > limit) {
    Fault fault =
        Fault(FaultKind::kMeshTooLarge,
              fmt::format("{} has {} elements, more than {} of {}.", field, count, quota, limit))
            .Field(field);
    return Fail(fault.Detail("count", std::to_string(count))
                    .Detail("quota", quota)
                    .Detail("limit", std::to_string(limit)));
  }
  return {};
}

template <class Mesh>
Status CheckArrays(const Mesh& mesh, int dimension, const MeshLimits& limits) {
  if (auto good = CheckArray(mesh.vertices_size(), dimension, "mesh.vertices", limits.max_vertices,
                             "max_vertices");
      !good) {
    return good;
  }
  return CheckArray(mesh.triangles_size(), 3, "mesh.triangles", limits.max_triangles,
                    "max_triangles");
}

template <class Mesh>
std::vector<Triangle> Triangles(const Mesh& mesh) {
  std::vector<Triangle> triangles(static_cast<std::size_t>(mesh.triangles_size() / 3));
  const std::uint32_t* next = mesh.triangles().data();
  for (Triangle& triangle : triangles) {
    std::copy_n(next, 3, triangle.begin());
    next += 3;
  }
  return triangles;
}

v1::Basis ToWire(Basis basis) {
  switch (basis) {
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

v1::EdgeWeights ToWire(Weights weights) {
  return weights == Weights::kUniform ? v1::EDGE_WEIGHTS_UNIFORM : v1::EDGE_WEIGHTS_COTANGENT;
}

Result<Basis> FromWire(v1::Basis basis) {
  switch (basis) {
    case v1::BASIS_UNSPECIFIED:
    case v1::BASIS_EDGE:
      return Basis::kEdge;
    case v1::BASIS_EDGE_AS_PUBLISHED:
      return Basis::kEdgeAsPublished;
    case v1::BASIS_FACE:
      return Basis::kFace;
    case v1::BASIS_VERTEX:
      return Basis::kVertex;
    default:
      return Fail(UnknownValue("energy.basis", basis));
  }
}

}  // namespace

Fault UnknownValue(const char* field, int value) {
  Fault fault =
      Fault(FaultKind::kInvalidOption,
            fmt::format("{} has the value {}, which this version does not know.", field, value))
          .Field(field);
  return fault.Detail("value", std::to_string(value));
}

Result<PlanarMesh> FromWire(const v1::PlanarMesh& mesh, const MeshLimits& limits) {
  if (auto good = CheckArrays(mesh, 2, limits); !good) return Fail(std::move(good.error()));
  PlanarMesh out;
  out.vertices.reserve(static_cast<std::size_t>(mesh.vertices_size() / 2));
  for (int i = 0; i < mesh.vertices_size(); i += 2) {
    out.vertices.emplace_back(mesh.vertices(i), mesh.vertices(i + 1));
  }
  out.triangles = Triangles(mesh);
  return out;
}

Result<SurfaceMesh> FromWire(const v1::SurfaceMesh& mesh, const MeshLimits& limits) {
  if (auto good = CheckArrays(mesh, 3, limits); !good) return Fail(std::move(good.error()));
  SurfaceMesh out;
  out.vertices.reserve(static_cast<std::size_t>(mesh.vertices_size() / 3));
  for (int i = 0; i < mesh.vertices_size(); i += 3) {
    out.vertices.push_back({mesh.vertices(i), mesh.vertices(i + 1), mesh.vertices(i + 2)});
  }
  out.triangles = Triangles(mesh);
  return out;
}

Result<EnergyOptions> FromWire(const v1::EnergyOptions& options, Weights default_weights,
                               std::size_t triangles) {
  EnergyOptions out;
  auto basis = FromWire(options.basis());
  if (!basis) return Fail(std::move(basis.error()));
  out.basis = *basis;
  switch (options.weights()) {
    case v1::EDGE_WEIGHTS_UNSPECIFIED:
      out.weights = default_weights;
      break;
    case v1::EDGE_WEIGHTS_UNIFORM:
      out.weights = Weights::kUniform;
      break;
    case v1::EDGE_WEIGHTS_COTANGENT:
      out.weights = Weights::kCotangent;
      break;
    default:
      return Fail(UnknownValue("energy.weights", options.weights()));
  }
  out.rigidity.assign(options.rigidity().begin(), options.rigidity().end());
  if (!out.rigidity.empty() && out.rigidity.size() != triangles) {
    Fault fault = Fault(FaultKind::kArrayLength,
                        fmt::format("energy.rigidity has {} numbers for {} triangles.",
                                    out.rigidity.size(), triangles))
                      .Field("energy.rigidity");
    return Fail(fault.Detail("length", std::to_string(out.rigidity.size()))
                    .Detail("expected", std::to_string(triangles)));
  }
  return out;
}

void ToWire(const std::vector<Warning>& warnings,
            google::protobuf::RepeatedPtrField<v1::Warning>* out) {
  for (const Warning& warning : warnings) {
    v1::Warning& added = *out->Add();
    added.set_kind(warning.kind);
    added.set_count(warning.count);
    added.mutable_elements()->Assign(warning.elements.begin(), warning.elements.end());
    added.set_message(warning.message);
  }
}

void ToWire(const app::MeshEntry& entry, v1::MeshInfo* out) {
  const RegistrationReport& report = entry.mesh->report();
  out->set_mesh_id(entry.mesh_id);
  out->set_content_hash(entry.content_hash);
  out->set_vertex_count(report.vertices);
  out->set_triangle_count(report.triangles);
  out->set_edge_count(report.edges);
  out->set_component_count(report.components);
  out->set_boundary_loop_count(report.boundary_loops);
  out->set_area(report.area);
  out->set_diagonal(report.diagonal);
  ToWire(report.warnings, out->mutable_warnings());
  out->set_bytes(report.bytes);
  out->mutable_energy()->set_basis(ToWire(entry.mesh->options().basis));
  out->mutable_energy()->set_weights(ToWire(entry.mesh->options().weights));
}

}  // namespace arap::rpc
