#include "proto/convert/mesh.h"

#include <iterator>
#include <string>

#include <arap/v1/deformation_service.pb.h>
#include <arap/v1/geometry.pb.h>
#include <fmt/format.h>

#include "core/base/try.h"
#include "proto/convert/plain.h"

namespace arap::convert {
namespace {

Status CheckSize(std::size_t count, const char* field, std::size_t limit, const char* quota) {
  if (count <= limit) return {};
  return Fail(Fault(FaultKind::kMeshTooLarge, fmt::format("{} has {} elements, more than {} of {}.",
                                                          field, count, quota, limit))
                  .Field(field)
                  .Detail("count", count)
                  .Detail("quota", quota)
                  .Detail("limit", limit));
}

Status CheckArray(int length, int group, const char* field, std::size_t limit, const char* quota) {
  CHECK_OK(CheckGroups(length, group, field));
  return CheckSize(static_cast<std::size_t>(length / group), field, limit, quota);
}

template <class Mesh>
Status CheckArrays(const Mesh& mesh, int dimension, const MeshLimits& limits) {
  CHECK_OK(CheckArray(mesh.vertices_size(), dimension, "mesh.vertices", limits.max_vertices,
                      "max_vertices"));
  return CheckArray(mesh.triangles_size(), 3, "mesh.triangles", limits.max_triangles,
                    "max_triangles");
}

constexpr EnumRow<v1::Basis, Basis> kBases[] = {
    {v1::BASIS_EDGE, Basis::kEdge},
    {v1::BASIS_EDGE_AS_PUBLISHED, Basis::kEdgeAsPublished},
    {v1::BASIS_FACE, Basis::kFace},
    {v1::BASIS_VERTEX, Basis::kVertex},
};
static_assert(std::size(kBases) == v1::Basis_ARRAYSIZE - 1);

constexpr EnumRow<v1::EdgeWeights, Weights> kWeights[] = {
    {v1::EDGE_WEIGHTS_UNIFORM, Weights::kUniform},
    {v1::EDGE_WEIGHTS_COTANGENT, Weights::kCotangent},
};
static_assert(std::size(kWeights) == v1::EdgeWeights_ARRAYSIZE - 1);

}  // namespace

Result<PlanarMesh> FromWire(const v1::PlanarMesh& mesh, const MeshLimits& limits) {
  CHECK_OK(CheckArrays(mesh, 2, limits));
  return PlanarMesh{Points(mesh.vertices()), Groups<std::uint32_t, 3>(mesh.triangles())};
}

Result<SurfaceMesh> FromWire(const v1::SurfaceMesh& mesh, const MeshLimits& limits) {
  CHECK_OK(CheckArrays(mesh, 3, limits));
  return SurfaceMesh{Groups<double, 3>(mesh.vertices()),
                     Groups<std::uint32_t, 3>(mesh.triangles())};
}

void ToWire(const PlanarMesh& mesh, v1::PlanarMesh* out) {
  AppendPoints(mesh.vertices, out->mutable_vertices());
  AppendGroups(mesh.triangles, out->mutable_triangles());
}

void ToWire(const SurfaceMesh& mesh, v1::SurfaceMesh* out) {
  AppendGroups(mesh.vertices, out->mutable_vertices());
  AppendGroups(mesh.triangles, out->mutable_triangles());
}

Result<std::vector<Outline>> FromWire(
    const google::protobuf::RepeatedPtrField<v1::Outline>& outlines, std::size_t max_points) {
  std::size_t points = 0;
  for (int i = 0; i < outlines.size(); ++i) {
    const std::string field = fmt::format("outlines[{}].points", i);
    CHECK_OK(CheckGroups(outlines[i].points_size(), 2, field));
    points += static_cast<std::size_t>(outlines[i].points_size()) / 2;
    CHECK_OK(CheckSize(points, "outlines", max_points, "max_vertices"));
  }
  std::vector<Outline> out;
  for (const v1::Outline& outline : outlines) out.push_back(Points(outline.points()));
  return out;
}

void ToWire(const std::vector<Outline>& outlines,
            google::protobuf::RepeatedPtrField<v1::Outline>* out) {
  for (const Outline& outline : outlines) {
    AppendPoints(outline, out->Add()->mutable_points());
  }
}

OutlineOptions OptionsFromWire(const v1::MeshOutlineRequest& request) {
  return {request.vertex_count(), request.tolerance(), request.expansion()};
}

void ToWire(const OutlineOptions& options, v1::MeshOutlineRequest* out) {
  out->set_vertex_count(options.vertices);
  out->set_tolerance(options.tolerance);
  out->set_expansion(options.expansion);
}

void ToWire(const QualityMesh& mesh, v1::MeshOutlineResponse* out) {
  ToWire(mesh.mesh, out->mutable_mesh());
  out->set_piece_count(static_cast<std::uint32_t>(mesh.pieces));
  out->set_hole_count(static_cast<std::uint32_t>(mesh.holes));
  out->set_smallest_angle_degrees(mesh.smallest_angle);
  out->set_outline_error(mesh.outline_error);
}

Result<EnergyOptions> FromWire(const v1::EnergyOptions& energy, EnergyOptions defaults) {
  EnergyOptions out;
  TRY(out.basis, ModelOf(kBases, energy.basis(), defaults.basis, "energy.basis"));
  TRY(out.weights, ModelOf(kWeights, energy.weights(), defaults.weights, "energy.weights"));
  out.rigidity = Values<double>(energy.rigidity());
  return out;
}

void ToWire(const EnergyOptions& energy, v1::EnergyOptions* out) {
  out->set_basis(WireOf(kBases, energy.basis));
  out->set_weights(WireOf(kWeights, energy.weights));
  Append(energy.rigidity, out->mutable_rigidity());
}

RepairOptions FromWire(const v1::RepairOptions& repair) {
  RepairOptions out;
  out.weld = repair.weld();
  out.drop_duplicates = repair.drop_duplicates();
  out.stitch = repair.stitch();
  if (repair.has_tolerance()) out.tolerance = repair.tolerance();
  return out;
}

void ToWire(const RepairOptions& repair, v1::RepairOptions* out) {
  out->set_weld(repair.weld);
  out->set_drop_duplicates(repair.drop_duplicates);
  out->set_stitch(repair.stitch);
  if (repair.tolerance) out->set_tolerance(*repair.tolerance);
}

std::vector<Warning> FromWire(const google::protobuf::RepeatedPtrField<v1::Warning>& warnings) {
  std::vector<Warning> out;
  for (const v1::Warning& warning : warnings) {
    out.push_back({warning.kind(), warning.count(), Values<std::uint32_t>(warning.elements()),
                   warning.message()});
  }
  return out;
}

void ToWire(const std::vector<Warning>& warnings,
            google::protobuf::RepeatedPtrField<v1::Warning>* out) {
  for (const Warning& warning : warnings) {
    v1::Warning& added = *out->Add();
    added.set_kind(warning.kind);
    added.set_count(warning.count);
    Append(warning.elements, added.mutable_elements());
    added.set_message(warning.message);
  }
}

RegistrationReport ReportFromWire(const v1::MeshInfo& mesh) {
  RegistrationReport report;
  report.vertices = mesh.vertex_count();
  report.triangles = mesh.triangle_count();
  report.edges = mesh.edge_count();
  report.components = mesh.component_count();
  report.boundary_loops = mesh.boundary_loop_count();
  report.area = mesh.area();
  report.diagonal = mesh.diagonal();
  report.warnings = FromWire(mesh.warnings());
  report.bytes = mesh.bytes();
  return report;
}

void ToWire(const RegistrationReport& report, v1::MeshInfo* out) {
  out->set_vertex_count(report.vertices);
  out->set_triangle_count(report.triangles);
  out->set_edge_count(report.edges);
  out->set_component_count(report.components);
  out->set_boundary_loop_count(report.boundary_loops);
  out->set_area(report.area);
  out->set_diagonal(report.diagonal);
  ToWire(report.warnings, out->mutable_warnings());
  out->set_bytes(report.bytes);
}

}  // namespace arap::convert
