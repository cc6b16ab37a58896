#include "client/src/answers.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "arap/v1/deformation_service.pb.h"
#include "arap/v1/server_service.pb.h"
#include "client/src/answer_checks.h"
#include "core/base/names.h"
#include "core/base/plane.h"
#include "core/base/try.h"
#include "proto/convert/deform.h"
#include "proto/convert/limits.h"
#include "proto/convert/mesh.h"
#include "proto/convert/plain.h"
#include "proto/convert/positions.h"

namespace arap::client::internal {
namespace {

constexpr std::size_t kMostSessionsOfAPage = 1000;

// Far from 0 single precision would lose what lies between two floats: it is never asked for without
// an origin.
convert::PositionFormat FormatOf(const ShapeOptions& options) {
  return {options.float64, !options.float64, options.encoding};
}

Status CheckId(const std::string& id, const std::string& asked, const char* what) {
  if (asked.empty() ? IsName(id) : id == asked) return {};
  if (asked.empty()) return Bad("The server answered the {} {}, which is no id.", what, Quote(id));
  return Bad("The server answered the {} {}, not {}.", what, Quote(id), Quote(asked));
}

// Every triangle once.
Status CheckOrder(const std::vector<std::uint32_t>& order) {
  std::vector<bool> seen(order.size(), false);
  for (const std::uint32_t triangle : order) {
    if (triangle >= seen.size() || seen[triangle]) {
      return Bad("The server answered a drawing order that does not have every triangle once.");
    }
    seen[triangle] = true;
  }
  return {};
}

Status CheckPick(const v1::PickResult& pick, std::optional<MeshSize> mesh) {
  if (!pick.hit()) return {};
  if (mesh) CHECK_OK(CheckIndices(std::array{pick.triangle()}, mesh->triangles, "triangle"));
  if (pick.barycentric_size() != 3) return Bad("The server answered a pick without its weights.");
  return CheckNumbers({pick.rest().x(), pick.rest().y(), pick.barycentric(0), pick.barycentric(1),
                       pick.barycentric(2)},
                      "a pick");
}

// Of a shape that says that it was not measured.
Status CheckUnmeasured(const v1::Shape& shape, bool measured) {
  if (measured) return Bad("The server answered a shape without the measures that were asked for.");
  if (shape.flipped_count() == 0 && shape.flipped_ids().empty() && shape.energy() == 0 &&
      shape.mean_stretch() == 0 && shape.max_stretch() == 0) {
    return {};
  }
  return Bad("The server answered measures of a shape that it says it has not measured.");
}

}  // namespace

Fault BadAnswer(std::string sentence) { return {FaultKind::kInternal, std::move(sentence)}; }

void ToWire(const ShapeOptions& options, v1::DeformOptions* out) {
  convert::ToWire(options.deform, out);
  convert::ToWire(FormatOf(options), out);
  out->set_include_flipped_ids(options.flipped_ids);
  out->set_boundary_only(options.boundary_only);
  convert::Append(options.vertex_subset, out->mutable_vertex_subset());
}

Result<std::vector<std::uint32_t>> VerticesFromWire(
    const google::protobuf::RepeatedField<std::uint32_t>& answered, const ShapeOptions& options,
    std::optional<MeshSize> mesh) {
  auto vertices = convert::Values<std::uint32_t>(answered);
  if (!options.boundary_only) {
    if (vertices != options.vertex_subset) {
      return Bad("The server answered positions of other vertices than were asked for.");
    }
    return vertices;
  }
  if (vertices.empty()) return Bad("The server did not answer which vertices are on the boundary.");
  if (mesh) CHECK_OK(CheckIndices(vertices, mesh->vertices, "vertex"));
  const auto grows = std::adjacent_find(vertices.begin(), vertices.end(), std::greater_equal<>());
  if (grows != vertices.end()) {
    return Bad("The server answered a boundary whose vertices do not ascend.");
  }
  return vertices;
}

Result<Shape> FromWire(const v1::Shape& shape, const ShapeQuestion& asked) {
  Shape out;
  TRY(auto read, convert::PositionsFromWire(shape, FormatOf(asked.options)));
  out.positions = std::move(read.positions);
  out.position_error = read.error;
  out.vertices = asked.vertices;
  if (!out.vertices.empty()) {
    CHECK_OK(CheckCount(out.positions.size(), out.vertices.size(), "positions"));
  } else if (asked.mesh && out.positions.size() != asked.mesh->vertices) {
    return Bad("The server answered a shape of {} vertices; the mesh has {}.", out.positions.size(),
               asked.mesh->vertices);
  }
  if (out.positions.empty()) return Bad("The server answered an empty shape.");
  CHECK_OK(CheckFinite(out.positions, "the position of vertex"));
  out.quality = convert::QualityFromWire(shape);
  if (!out.quality.measured) CHECK_OK(CheckUnmeasured(shape, asked.measured));
  CHECK_OK(CheckNumbers({out.quality.worst_handle_error, out.quality.energy,
                         out.quality.mean_stretch, out.quality.max_stretch},
                        "the quality of a shape"));
  out.worst_handle_id = shape.worst_handle_id();
  if (!out.worst_handle_id.empty()) CHECK_OK(CheckId(out.worst_handle_id, {}, "handle"));
  out.flipped_ids = convert::Values<std::uint32_t>(shape.flipped_ids());
  if (!asked.options.flipped_ids) {
    CHECK_OK(CheckCount(out.flipped_ids.size(), 0, "flipped triangles"));
  } else if (asked.mesh) {
    CHECK_OK(CheckIndices(out.flipped_ids, asked.mesh->triangles, "triangle"));
    if (out.flipped_ids.size() > asked.mesh->triangles) {
      return Bad("The server answered more flipped triangles than there are triangles.");
    }
  }
  const auto picks = static_cast<std::size_t>(shape.picks_size());
  CHECK_OK(CheckCount(picks, asked.picks.value_or(std::min(picks, convert::kMaxPicks)), "picks"));
  for (const v1::PickResult& pick : shape.picks()) {
    CHECK_OK(CheckPick(pick, asked.mesh));
    out.picks.push_back(convert::FromWire(pick));
  }
  out.sequence = shape.sequence();
  out.replaced = shape.replaced();
  out.handle_set_revision = shape.handle_set_revision();
  out.queue_micros = shape.queue_micros();
  out.solve_micros = shape.solve_micros();
  return out;
}

Result<MeshInfo> FromWire(const v1::MeshInfo& mesh, const std::string& mesh_id,
                          const PlanarMesh* sent) {
  CHECK_OK(CheckId(mesh.mesh_id(), mesh_id, "mesh"));
  if (sent != nullptr) {
    CHECK_OK(CheckCount(mesh.vertex_count(), sent->vertices.size(), "vertices"));
    CHECK_OK(CheckCount(mesh.triangle_count(), sent->triangles.size(), "triangles"));
  }
  CHECK_OK(CheckNumbers({mesh.area(), mesh.diagonal()}, "a mesh"));
  MeshInfo out;
  out.id = mesh.mesh_id();
  out.content_hash = mesh.content_hash();
  out.report = convert::ReportFromWire(mesh);
  if (auto energy = convert::FromWire(mesh.energy(), EnergyOptions{})) out.energy = *energy;
  out.repairs = convert::FromWire(mesh.repair());
  return out;
}

Result<OutlineMesh> FromWire(const v1::MeshOutlineResponse& response) {
  constexpr std::size_t kAny = std::numeric_limits<std::size_t>::max();
  auto mesh = convert::FromWire(response.mesh(), MeshLimits{kAny, kAny});
  if (!mesh) return Bad("The server answered a mesh with an array of odd length.");
  CHECK_OK(CheckFinite(mesh->vertices, "vertex"));
  for (const Triangle& triangle : mesh->triangles) {
    CHECK_OK(CheckIndices(triangle, mesh->vertices.size(), "vertex"));
    if (!(TwiceArea(triangle, mesh->vertices) > 0)) {
      return Bad("The server answered a triangle that does not run counter-clockwise.");
    }
  }
  CHECK_OK(CheckNumbers({response.smallest_angle_degrees(), response.outline_error()}, "a mesh"));
  return OutlineMesh{{*std::move(mesh), response.piece_count(), response.hole_count(),
                      response.smallest_angle_degrees(), response.outline_error()},
                     convert::Micros(response.queue_time()),
                     convert::Micros(response.solve_time())};
}

Result<HandleSetInfo> FromWire(const v1::HandleSetInfo& set, const SetQuestion& asked,
                               std::optional<MeshSize> mesh) {
  CHECK_OK(CheckId(set.handle_set_id(), asked.id, "handle set"));
  CHECK_OK(CheckId(set.mesh_id(), asked.mesh_id, "mesh"));
  HandleSetInfo out;
  out.id = set.handle_set_id();
  out.mesh_id = set.mesh_id();
  std::set<std::string_view> ids;
  for (const v1::HandleInfo& handle : set.handles()) {
    CHECK_OK(CheckId(handle.handle_id(), {}, "handle"));
    if (!ids.insert(handle.handle_id()).second) {
      return Bad("The server answered the handle {} twice.", Quote(handle.handle_id()));
    }
    CHECK_OK(CheckNumbers({handle.rest().x(), handle.rest().y(), handle.snapped_distance()},
                          "a handle"));
    out.handles.push_back(convert::FromWire(handle));
  }
  const std::size_t count = out.handles.size(), last = asked.last.size();
  if (count < last || (asked.all && count != last)) {
    return Bad("The server answered a set of {} handles; {} were sent.", count, last);
  }
  for (std::size_t i = 0; i < last; ++i) {
    CHECK_OK(CheckId(out.handles[count - last + i].handle.id, asked.last[i].id, "handle"));
  }
  out.row_count = set.row_count();
  out.bytes = set.bytes();
  out.warnings = convert::FromWire(set.warnings());
  out.depth = convert::Values<double>(set.depth());
  for (const double depth : out.depth) CHECK_OK(CheckNumbers({depth}, "the depths"));
  out.draw_order = convert::Values<std::uint32_t>(set.draw_order());
  CHECK_OK(CheckOrder(out.draw_order));
  if (mesh && !out.depth.empty()) CHECK_OK(CheckCount(out.depth.size(), mesh->vertices, "depths"));
  if (mesh && !out.draw_order.empty()) {
    CHECK_OK(CheckCount(out.draw_order.size(), mesh->triangles, "triangles in drawing order"));
  }
  out.revision = set.revision();
  out.resting_components = set.resting_components();
  out.translating_components = set.translating_components();
  return out;
}

Result<SessionInfo> FromWire(const v1::Session& session, const std::string& id) {
  CHECK_OK(CheckId(session.session_id(), id, "session"));
  SessionInfo out;
  out.id = session.session_id();
  out.create_time = convert::FromWire(session.create_time());
  out.expire_time = convert::FromWire(session.expire_time());
  out.ttl = convert::FromWire(session.ttl());
  out.labels.insert(session.labels().begin(), session.labels().end());
  for (const std::string& mesh : session.mesh_ids()) {
    CHECK_OK(CheckId(mesh, {}, "mesh"));
    out.mesh_ids.push_back(mesh);
  }
  for (const std::string& set : session.handle_set_ids()) {
    CHECK_OK(CheckId(set, {}, "handle set"));
    out.handle_set_ids.push_back(set);
  }
  return out;
}

Result<SessionPage> FromWire(const v1::ListSessionsResponse& response, std::uint32_t page_size,
                             const std::string& page_token) {
  const std::size_t most = page_size == 0 ? kMostSessionsOfAPage : page_size;
  const auto count = static_cast<std::size_t>(response.sessions_size());
  if (count > most) return Bad("The server answered {} sessions; {} were asked.", count, most);
  SessionPage page;
  for (const v1::Session& session : response.sessions()) {
    TRY(page.sessions.emplace_back(), FromWire(session, {}));
  }
  page.next_page_token = response.next_page_token();
  if (!page.next_page_token.empty() && page.next_page_token == page_token) {
    return Bad("The server answered a page of sessions that leads back to itself.");
  }
  return page;
}

ServerInfo FromWire(const v1::GetServerInfoResponse& response) {
  ServerInfo out;
  out.version = response.version();
  out.limits = convert::FromWire(response.limits());
  out.capabilities.assign(response.capabilities().begin(), response.capabilities().end());
  out.workers = response.workers();
  return out;
}

void KnownSizes::Know(const std::string& mesh_id, MeshSize size) {
  const MutexLock lock(&mutex_);
  meshes_[mesh_id] = size;
}

void KnownSizes::Forget(const std::string& mesh_id) {
  const MutexLock lock(&mutex_);
  meshes_.erase(mesh_id);
  std::erase_if(sets_, [&](const auto& set) { return set.second == mesh_id; });
}

void KnownSizes::KnowSet(const std::string& handle_set_id, const std::string& mesh_id) {
  const MutexLock lock(&mutex_);
  sets_[handle_set_id] = mesh_id;
}

void KnownSizes::ForgetSet(const std::string& handle_set_id) {
  const MutexLock lock(&mutex_);
  sets_.erase(handle_set_id);
}

std::optional<MeshSize> KnownSizes::OfSet(const std::string& handle_set_id) const {
  const MutexLock lock(&mutex_);
  const auto set = sets_.find(handle_set_id);
  if (set == sets_.end()) return std::nullopt;
  const auto mesh = meshes_.find(set->second);
  return mesh == meshes_.end() ? std::nullopt : std::optional(mesh->second);
}

std::optional<MeshSize> KnownSizes::OfMesh(const std::string& mesh_id) const {
  const MutexLock lock(&mutex_);
  const auto mesh = meshes_.find(mesh_id);
  return mesh == meshes_.end() ? std::nullopt : std::optional(mesh->second);
}

}  // namespace arap::client::internal
