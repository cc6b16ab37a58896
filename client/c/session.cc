// Connections, sessions, meshes and handles for C.
#include <utility>

#include "client/c/objects.h"

using arap::Result;
using arap::Status;
using arap::c::Bad;
using arap::c::CallOf;
using arap::c::Guard;
using arap::c::IdOf;
using arap::c::IdOrNone;
using arap::c::Need;
using arap::c::OptionsOf;
using arap::c::TextOf;
namespace client = arap::client;

// NOLINTBEGIN(readability-identifier-naming): the names of C.
struct arap_mesh {
  client::MeshInfo info;
  arap_warnings warnings;
};

struct arap_handle_set {
  client::HandleSetInfo info;
  std::vector<arap::Complex> rest;
  arap_warnings warnings;
};
// NOLINTEND(readability-identifier-naming)

namespace arap::c {
namespace {

Result<client::Handle> HandleOf(const arap_handle& given, const char* field, std::size_t index) {
  client::Handle handle;
  TRY(handle.id, IdOf(given.id, Member(field, index, "id").c_str()));
  switch (given.where) {
    case ARAP_AT_VERTEX:
      handle.anchor = client::VertexAnchor{given.index};
      break;
    case ARAP_IN_TRIANGLE:
      handle.anchor = client::TriangleAnchor{given.index, {given.at[0], given.at[1], given.at[2]}};
      break;
    case ARAP_AT_POINT:
      handle.anchor = client::PointAnchor{{given.at[0], given.at[1]}};
      break;
    default:
      return Fail(BadChoice(Member(field, index, "where"), "is no place", given.where));
  }
  if (given.weight != 0) handle.weight = given.weight;
  handle.hard = given.hard != 0;
  handle.oriented = given.oriented != 0;
  if (given.snap != 0) handle.outside = client::Outside::kSnap;
  handle.area_radius = given.area_radius;
  handle.depth = given.depth;
  handle.depth_falloff = given.depth_falloff;
  return handle;
}

Result<client::EnergyOptions> EnergyOf(const arap_mesh_options& given, std::size_t triangles) {
  client::EnergyOptions energy;
  TRY(energy.basis, BasisOf(given.basis, energy.basis));
  switch (given.weights) {
    case ARAP_WEIGHTS_DEFAULT:
    case ARAP_WEIGHTS_UNIFORM:
      break;
    case ARAP_WEIGHTS_COTANGENT:
      energy.weights = client::Weights::kCotangent;
      break;
    default:
      return Fail(BadChoice("weights", "are no weights", given.weights));
  }
  energy.rigidity = NumbersOf(given.rigidity, triangles);
  return energy;
}

arap_handle_set* SetOf(client::Compilation&& compiled) {
  auto set = std::make_unique<arap_handle_set>();
  set->info = std::move(compiled.handle_set);
  for (const client::PlacedHandle& handle : set->info.handles) set->rest.push_back(handle.rest);
  set->warnings.all = std::move(set->info.warnings);
  return set.release();
}

}  // namespace

Result<std::vector<client::Handle>> HandlesOf(const arap_handle* handles, std::size_t count,
                                              const char* field) {
  TRY(const auto given, ArrayOf(handles, count, field));
  std::vector<client::Handle> ours;
  ours.reserve(count);
  for (const arap_handle& handle : given) {
    TRY(auto next, HandleOf(handle, field, ours.size()));
    ours.push_back(std::move(next));
  }
  return ours;
}

Result<std::vector<std::string>> IdsOf(const char* const* ids, std::size_t count,
                                       const char* field) {
  TRY(const auto given, ArrayOf(ids, count, field));
  std::vector<std::string> ours;
  ours.reserve(count);
  for (const char* id : given) {
    TRY(auto next, IdOf(id, field));
    ours.push_back(std::move(next));
  }
  return ours;
}

}  // namespace arap::c

extern "C" {

arap_error* arap_connect(const char* address, const arap_connect_options* options,
                         arap_client** out) {
  return Guard([&]() -> Status {
    CHECK_OK(Need(address, "address"));
    CHECK_OK(Need(out, "out"));
    TRY(const auto given, OptionsOf(options, "options"));
    client::ConnectOptions connect;
    connect.token = TextOf(given.token);
    connect.user = TextOf(given.user);
    connect.tls = given.tls != 0;
    connect.token_in_plaintext = given.token_in_plaintext != 0;
    connect.root_certificates = TextOf(given.root_certificates);
    connect.certificate = TextOf(given.certificate);
    connect.key = TextOf(given.key);
    connect.server_name = TextOf(given.server_name);
    TRY(auto connected, client::Client::Connect(address, connect));
    *out = new arap_client{std::move(connected)};
    return {};
  });
}

arap_error* arap_wait_ready(const arap_client* client, int64_t timeout_ms) {
  return Guard([&]() -> Status {
    CHECK_OK(Need(client, "client"));
    const std::chrono::milliseconds none{0};
    return client->client.WaitReady(arap::c::MillisOf(timeout_ms, none, client::kNoLimit));
  });
}

void arap_client_free(arap_client* client) { delete client; }

arap_error* arap_create_session(const arap_client* client, const char* id, int64_t ttl_ms,
                                const arap_call_options* call, arap_session** out) {
  return Guard([&]() -> Status {
    CHECK_OK(Need(client, "client"));
    CHECK_OK(Need(out, "out"));
    client::SessionOptions options;
    TRY(options.id, IdOrNone(id, "id"));
    if (ttl_ms < 0) return Fail(Bad("ttl_ms", "ttl_ms is below 0."));
    const std::chrono::milliseconds none{0};
    if (ttl_ms != 0) options.ttl = arap::c::MillisOf(ttl_ms, none, none);
    TRY(const auto calling, CallOf(call));
    TRY(auto session, client->client.CreateSession(options, calling));
    *out = new arap_session{std::move(session)};
    return {};
  });
}

arap_error* arap_attach_session(const arap_client* client, const char* id, arap_session** out) {
  return Guard([&]() -> Status {
    CHECK_OK(Need(client, "client"));
    CHECK_OK(Need(out, "out"));
    TRY(auto name, IdOf(id, "id"));
    *out = new arap_session{client->client.AttachSession(std::move(name))};
    return {};
  });
}

const char* arap_session_id(const arap_session* session) { return session->session.id().c_str(); }

arap_error* arap_delete_session(const arap_session* session, const arap_call_options* call) {
  return Guard([&]() -> Status {
    CHECK_OK(Need(session, "session"));
    TRY(const auto calling, CallOf(call));
    return session->session.Delete(calling);
  });
}

void arap_session_free(arap_session* session) { delete session; }

arap_error* arap_register_mesh(const arap_session* session, const char* mesh_id,
                               const double* vertices, size_t vertex_count,
                               const uint32_t* triangles, size_t triangle_count,
                               const arap_mesh_options* options, const arap_call_options* call,
                               arap_mesh** out) {
  return Guard([&]() -> Status {
    CHECK_OK(Need(session, "session"));
    TRY(const auto id, IdOrNone(mesh_id, "mesh_id"));
    client::PlanarMesh mesh;
    TRY(mesh.vertices, arap::c::PointsOf(vertices, vertex_count, "vertices"));
    TRY(mesh.triangles, arap::c::TrianglesOf(triangles, triangle_count));
    TRY(const auto given, OptionsOf(options, "options"));
    TRY(const auto energy, arap::c::EnergyOf(given, triangle_count));
    TRY(const auto calling, CallOf(call));
    TRY(auto registered, session->session.RegisterMesh(mesh, energy, id, calling,
                                                       arap::c::RepairsOf(given.repairs)));
    if (out == nullptr) return {};
    auto answer = std::make_unique<arap_mesh>();
    answer->info = std::move(registered.mesh);
    answer->warnings.all = std::move(answer->info.report.warnings);
    *out = answer.release();
    return {};
  });
}

const char* arap_mesh_id(const arap_mesh* mesh) { return mesh->info.id.c_str(); }
size_t arap_mesh_vertex_count(const arap_mesh* mesh) { return mesh->info.report.vertices; }
size_t arap_mesh_triangle_count(const arap_mesh* mesh) { return mesh->info.report.triangles; }
size_t arap_mesh_component_count(const arap_mesh* mesh) { return mesh->info.report.components; }
double arap_mesh_area(const arap_mesh* mesh) { return mesh->info.report.area; }
const arap_warnings* arap_mesh_warnings(const arap_mesh* mesh) { return &mesh->warnings; }
void arap_mesh_free(arap_mesh* mesh) { delete mesh; }

arap_error* arap_compile_handles(const arap_session* session, const char* handle_set_id,
                                 const char* mesh_id, const arap_handle* handles,
                                 size_t handle_count, const arap_call_options* call,
                                 arap_handle_set** out) {
  return Guard([&]() -> Status {
    CHECK_OK(Need(session, "session"));
    TRY(const auto id, IdOf(handle_set_id, "handle_set_id"));
    TRY(const auto mesh, IdOf(mesh_id, "mesh_id"));
    TRY(const auto ours, arap::c::HandlesOf(handles, handle_count, "handles"));
    TRY(const auto calling, CallOf(call));
    TRY(auto compiled, session->session.CompileHandles(id, mesh, ours, calling));
    if (out != nullptr) *out = arap::c::SetOf(std::move(compiled));
    return {};
  });
}

arap_error* arap_edit_handles(const arap_session* session, const char* handle_set_id,
                              const char* const* remove, size_t remove_count,
                              const arap_handle* add, size_t add_count,
                              const arap_call_options* call, arap_handle_set** out) {
  return Guard([&]() -> Status {
    CHECK_OK(Need(session, "session"));
    TRY(const auto id, IdOf(handle_set_id, "handle_set_id"));
    TRY(const auto gone, arap::c::IdsOf(remove, remove_count, "remove"));
    TRY(const auto added, arap::c::HandlesOf(add, add_count, "add"));
    TRY(const auto calling, CallOf(call));
    TRY(auto compiled, session->session.EditHandles(id, gone, added, calling));
    if (out != nullptr) *out = arap::c::SetOf(std::move(compiled));
    return {};
  });
}

size_t arap_handle_set_count(const arap_handle_set* set) { return set->rest.size(); }
const double* arap_handle_set_rest(const arap_handle_set* set) {
  return arap::c::Doubles(set->rest);
}
const char* arap_handle_set_handle_id(const arap_handle_set* set, size_t index) {
  const auto& handles = set->info.handles;
  return index < handles.size() ? handles[index].handle.id.c_str() : nullptr;
}
uint64_t arap_handle_set_revision(const arap_handle_set* set) { return set->info.revision; }
const arap_warnings* arap_handle_set_warnings(const arap_handle_set* set) { return &set->warnings; }
void arap_handle_set_free(arap_handle_set* set) { delete set; }

}  // extern "C"
