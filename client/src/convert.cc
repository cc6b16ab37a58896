#include "client/src/convert.h"

#include <utility>

#include "arap/v1/deformation_service.pb.h"
#include "arap/v1/server_service.pb.h"
#include "core/base/try.h"
#include "proto/convert/handles.h"
#include "proto/convert/limits.h"
#include "proto/convert/mesh.h"
#include "proto/convert/plain.h"
#include "proto/convert/shape.h"

namespace arap::client::internal {
void ToWire(const ShapeOptions& options, v1::DeformOptions* out) {
  convert::ToWire(options.deform, out);
  out->set_float64(options.float64);
  out->set_include_flipped_ids(options.flipped_ids);
}

MeshInfo FromWire(const v1::MeshInfo& mesh) {
  MeshInfo out;
  out.id = mesh.mesh_id();
  out.content_hash = mesh.content_hash();
  out.report = convert::ReportFromWire(mesh);
  if (auto energy = convert::FromWire(mesh.energy(), EnergyOptions{})) out.energy = *energy;
  return out;
}

HandleSetInfo FromWire(const v1::HandleSetInfo& set) {
  HandleSetInfo out;
  out.id = set.handle_set_id();
  out.mesh_id = set.mesh_id();
  for (const v1::HandleInfo& handle : set.handles())
    out.handles.push_back(convert::FromWire(handle));
  out.row_count = set.row_count();
  out.bytes = set.bytes();
  out.warnings = convert::FromWire(set.warnings());
  out.depth = convert::Values<double>(set.depth());
  out.draw_order = convert::Values<std::uint32_t>(set.draw_order());
  out.revision = set.revision();
  out.resting_components = set.resting_components();
  out.translating_components = set.translating_components();
  return out;
}

Result<Shape> FromWire(const v1::Shape& shape) {
  Shape out;
  TRY(out.positions, convert::PositionsFromWire(shape));
  out.quality = convert::QualityFromWire(shape);
  out.worst_handle_id = shape.worst_handle_id();
  out.flipped_ids = convert::Values<std::uint32_t>(shape.flipped_ids());
  for (const v1::PickResult& pick : shape.picks()) out.picks.push_back(convert::FromWire(pick));
  out.sequence = shape.sequence();
  out.replaced = shape.replaced();
  out.handle_set_revision = shape.handle_set_revision();
  out.queue_micros = shape.queue_micros();
  out.solve_micros = shape.solve_micros();
  return out;
}

SessionInfo FromWire(const v1::Session& session) {
  SessionInfo out;
  out.id = session.session_id();
  out.create_time = convert::FromWire(session.create_time());
  out.expire_time = convert::FromWire(session.expire_time());
  out.ttl = convert::FromWire(session.ttl());
  out.labels.insert(session.labels().begin(), session.labels().end());
  out.mesh_ids.assign(session.mesh_ids().begin(), session.mesh_ids().end());
  out.handle_set_ids.assign(session.handle_set_ids().begin(), session.handle_set_ids().end());
  return out;
}

ServerInfo FromWire(const v1::GetServerInfoResponse& response) {
  ServerInfo out;
  out.version = response.version();
  out.limits = convert::FromWire(response.limits());
  out.capabilities.assign(response.capabilities().begin(), response.capabilities().end());
  out.workers = response.workers();
  return out;
}

}  // namespace arap::client::internal
