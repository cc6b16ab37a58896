#include "server/rpc/costs.h"

#include "arap/model/flatten.h"
#include "server/budget/estimate.h"
#include "server/engine.h"
#include "server/sessions/rebuild.h"

namespace arap::rpc {
namespace {

using app::Warmth;

// Of what is to be built from a mesh that is not in memory: long, and nothing more is known.
constexpr Expected kCold{true, 1};

std::size_t VerticesOf(const CompiledHandles& handles) {
  return handles.mesh()->mesh().vertices.size();
}

// As app::RowsOf, before the handles are read.
std::size_t RowsOf(const google::protobuf::RepeatedPtrField<v1::Handle>& handles,
                   std::size_t vertices) {
  std::size_t rows = 0;
  for (const v1::Handle& handle : handles) {
    const std::size_t held = handle.oriented() ? 3 : 1;
    rows += handle.area_radius() > 0 ? vertices : held;
  }
  return rows;
}

}  // namespace

Expected ExpectedOf(app::Engine&, const app::Session*, const v1::RegisterMeshRequest& request) {
  const auto vertices = static_cast<std::size_t>(request.mesh().vertices_size()) / 2;
  return {false, app::RegistrationSeconds(vertices)};
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
  return {false, app::CompilationSeconds(vertices, RowsOf(request.handles(), vertices))};
}

Expected ExpectedOf(app::Engine& engine, const app::Session* session,
                    const v1::EditHandlesRequest& request) {
  if (session == nullptr) return kCold;
  const auto set = app::PeekHandleSet(engine, *session, request.handle_set_id());
  if (set.warmth == Warmth::kMissing) return {};
  if (set.warmth == Warmth::kCold) return kCold;
  const std::size_t vertices = VerticesOf(*set.handles);
  return {false, app::EditSeconds(vertices, set.handles->rows(), RowsOf(request.add(), vertices))};
}

Expected ExpectedOf(app::Engine& engine, const app::Session* session,
                    const v1::GetHandleSetRequest& request) {
  if (session == nullptr) return kCold;
  const auto set = app::PeekHandleSet(engine, *session, request.handle_set_id());
  if (set.warmth == Warmth::kMissing) return {};
  if (set.warmth == Warmth::kCold) return kCold;
  return {false, app::DepthOrderSeconds(*set.handles)};
}

Expected ExpectedOf(app::Engine& engine, const app::Session* session,
                    const v1::DeformRequest& request) {
  if (session == nullptr) return kCold;
  const auto set = app::PeekHandleSet(engine, *session, request.handle_set_id());
  if (set.warmth == Warmth::kMissing) return {};
  if (set.warmth == Warmth::kCold) return kCold;
  const std::size_t vertices = VerticesOf(*set.handles);
  const auto picks = static_cast<std::size_t>(request.pick_points_size()) / 2;
  return {false, app::FrameSeconds(vertices, request.options().refine()) +
                     app::PickSeconds(vertices, picks)};
}

Expected ExpectedOf(app::Engine&, const app::Session*, const v1::FlattenRequest& request) {
  const auto triangles = static_cast<std::size_t>(request.mesh().triangles_size()) / 3;
  const std::uint32_t refine =
      request.has_refine() ? request.refine() : static_cast<std::uint32_t>(kServiceRefine);
  return {false, app::FlatteningSeconds(triangles, refine)};
}

}  // namespace arap::rpc
