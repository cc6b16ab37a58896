// Triangles inside outlines for C.
#include <utility>

#include "client/c/objects.h"

using arap::Status;
using arap::c::Need;
namespace client = arap::client;

// NOLINTBEGIN(readability-identifier-naming): the names of C.
struct arap_outline_mesh {
  client::QualityMesh made;
};
// NOLINTEND(readability-identifier-naming)

namespace arap::c {
namespace {

Result<std::vector<client::Outline>> OutlinesOf(const double* points, const std::size_t* lengths,
                                                std::size_t count) {
  TRY(const auto given, ArrayOf(lengths, count, "lengths"));
  std::size_t left = PTRDIFF_MAX / (2 * sizeof(double));
  for (const std::size_t length : given) {
    if (length > left) return Fail(Bad("lengths", "There cannot be so many points."));
    left -= length;
  }
  std::vector<client::Outline> outlines;
  for (const std::size_t length : given) {
    TRY(auto next, PointsOf(points, length, "points"));
    if (length > 0) points += 2 * length;
    outlines.push_back(std::move(next));
  }
  return outlines;
}

}  // namespace
}  // namespace arap::c

extern "C" {

arap_error* arap_mesh_outline(const arap_client* client, const double* points,
                              const size_t* lengths, size_t outline_count,
                              const arap_outline_options* options, const arap_call_options* call,
                              arap_outline_mesh** out) {
  return arap::c::Guard([&]() -> Status {
    CHECK_OK(Need(client, "client"));
    CHECK_OK(Need(out, "out"));
    TRY(const auto outlines, arap::c::OutlinesOf(points, lengths, outline_count));
    TRY(const auto given, arap::c::OptionsOf(options, "options"));
    TRY(const auto calling, arap::c::CallOf(call));
    TRY(auto made, client->client.MeshOutline(
                       outlines, {given.vertices, given.tolerance, given.expansion}, calling));
    *out = new arap_outline_mesh{std::move(made.triangles)};
    return {};
  });
}

size_t arap_outline_mesh_vertex_count(const arap_outline_mesh* mesh) {
  return mesh->made.mesh.vertices.size();
}
const double* arap_outline_mesh_vertices(const arap_outline_mesh* mesh) {
  return arap::c::Doubles(mesh->made.mesh.vertices);
}
size_t arap_outline_mesh_triangle_count(const arap_outline_mesh* mesh) {
  return mesh->made.mesh.triangles.size();
}
const uint32_t* arap_outline_mesh_triangles(const arap_outline_mesh* mesh) {
  return reinterpret_cast<const uint32_t*>(mesh->made.mesh.triangles.data());
}
size_t arap_outline_mesh_piece_count(const arap_outline_mesh* mesh) { return mesh->made.pieces; }
size_t arap_outline_mesh_hole_count(const arap_outline_mesh* mesh) { return mesh->made.holes; }
double arap_outline_mesh_smallest_angle(const arap_outline_mesh* mesh) {
  return mesh->made.smallest_angle;
}
double arap_outline_mesh_outline_error(const arap_outline_mesh* mesh) {
  return mesh->made.outline_error;
}
void arap_outline_mesh_free(arap_outline_mesh* mesh) { delete mesh; }

}  // extern "C"
