#include "server/rpc/costs.h"

#include "arap/core/flattener.h"
#include "proto/convert/deform.h"
#include "proto/convert/flatten.h"
#include "server/budget/estimate.h"
#include "server/engine.h"
#include "server/sessions/workshop.h"

namespace arap::rpc {
namespace {

using app::Warmth;

// Of what is to be built from a mesh that is not in memory: long, and nothing more is known.
constexpr Expected kCold{true, 1};

// What CountRows will find, before the handles are read.
RowCount RowsOf(const google::protobuf::RepeatedPtrField<v1::Handle>& handles,
                std::size_t vertices) {
  RowCount count;
  for (const v1::Handle& handle : handles) {
    const bool area = handle.area_radius() > 0;
    const std::size_t held = handle.oriented() ? 3 : 1;
    count.rows += area ? vertices : held;
    if (handle.hard() && !area && handle.anchor_case() != v1::Handle::kVertex) count.inside += held;
    if (handle.depth() != 0) ++count.depths;
  }
  return count;
}

}  // namespace

Expected ExpectedOf(app::Engine&, const app::Session*, const v1::RegisterMeshRequest& request) {
  const auto vertices = static_cast<std::size_t>(request.mesh().vertices_size()) / 2;
  return {false, app::SecondsOf(EstimateRegistration(vertices, Basis::kEdge))};
}

Expected ExpectedOf(app::Engine& engine, const app::Session* session,
                    const v1::GetMeshRequest& request) {
  if (session == nullptr) return kCold;
  const auto mesh = app::PeekMesh(engine, *session, request.mesh_id());
  return mesh.warmth == Warmth::kCold ? kCold : Expected{};
}

Expected ExpectedOf(app::Engine& engine, const app::Session* session,
                    const v1::CompileHandlesRequest& request) {
  if (session == nullptr) return kCold;
  const auto mesh = app::PeekMesh(engine, *session, request.mesh_id());
  if (mesh.warmth == Warmth::kMissing) return {};
  if (mesh.warmth == Warmth::kCold) return kCold;
  const std::size_t vertices = mesh.mesh->mesh().vertices.size();
  return {false,
          app::SecondsOf(EstimateCompilation(*mesh.mesh, RowsOf(request.handles(), vertices)))};
}

Expected ExpectedOf(app::Engine& engine, const app::Session* session,
                    const v1::EditHandlesRequest& request) {
  if (session == nullptr) return kCold;
  const auto set = app::PeekHandleSet(engine, *session, request.handle_set_id());
  if (set.warmth == Warmth::kMissing) return {};
  if (set.warmth == Warmth::kCold) return kCold;
  const std::size_t vertices = set.handles->mesh()->mesh().vertices.size();
  return {false,
          app::SecondsOf(EstimateEdit(*set.handles, {}, RowsOf(request.add(), vertices)).cost)};
}

Expected ExpectedOf(app::Engine& engine, const app::Session* session,
                    const v1::GetHandleSetRequest& request) {
  if (session == nullptr) return kCold;
  const auto set = app::PeekHandleSet(engine, *session, request.handle_set_id());
  return set.warmth == Warmth::kCold ? kCold : Expected{};
}

Expected ExpectedOf(app::Engine& engine, const app::Session* session,
                    const v1::DeformRequest& request) {
  if (session == nullptr) return kCold;
  const auto set = app::PeekHandleSet(engine, *session, request.handle_set_id());
  if (set.warmth == Warmth::kMissing) return {};
  if (set.warmth == Warmth::kCold) return kCold;
  const auto options = convert::FromWire(request.options(), engine.limits.max_refine);
  if (!options) return {};
  const auto picks = static_cast<std::size_t>(request.pick_points_size()) / 2;
  return {false, app::SecondsOf(EstimateFrame(*set.handles, *options, picks))};
}

Expected ExpectedOf(app::Engine& engine, const app::Session*, const v1::FlattenRequest& request) {
  const auto options = convert::FromWire(request, engine.limits.max_refine);
  if (!options) return {};
  // By lengths alone: as if it were one chart, which is the most that it can take.
  const auto vertices = static_cast<std::size_t>(request.mesh().vertices_size()) / 3;
  const auto triangles = static_cast<std::size_t>(request.mesh().triangles_size()) / 3;
  return {false, 1e-3 * EstimateFlatten({vertices, triangles, 1, vertices}, *options,
                                        !request.surface_key().empty())
                            .milliseconds};
}

}  // namespace arap::rpc
