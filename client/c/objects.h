// What is behind the pointers that C holds, and what sessions, shapes, streams, flattening and its
// jobs take from C.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "arap/client/client.h"
#include "client/c/guard.h"

// NOLINTBEGIN(readability-identifier-naming): the names of C.
struct arap_client {
  arap::client::Client client;
};

struct arap_session {
  arap::client::Session session;
};

struct arap_shape {
  arap::client::Shape shape;
};
struct arap_flat {
  struct Drawing {
    std::vector<arap::client::DrawingFile> files;
    arap_warnings warnings;
  };

  arap::client::Flattening flat;
  arap_warnings warnings;
  std::vector<Drawing> drawings;
};
// NOLINTEND(readability-identifier-naming)

namespace arap::c {

// "handles[3].id".
inline std::string Member(const char* field, std::size_t index, const char* member) {
  return std::string(field) + "[" + std::to_string(index) + "]." + member;
}

Result<std::vector<client::Handle>> HandlesOf(const arap_handle* handles, std::size_t count,
                                              const char* field);
Result<std::vector<client::HandleTarget>> TargetsOf(const arap_target* targets, std::size_t count);
Result<std::vector<std::string>> IdsOf(const char* const* ids, std::size_t count,
                                       const char* field);
Result<client::ShapeOptions> ShapeOptionsOf(const arap_shape_options* options, const char* field);

// A surface to lay flat, and how.
struct FlattenWork {
  client::SurfaceMesh mesh;
  client::FlattenQuery query;
};
Result<FlattenWork> WorkOf(const double* vertices, std::size_t vertex_count,
                           const std::uint32_t* triangles, std::size_t triangle_count,
                           const arap_flatten_options* options);
// The drawings and parts of a query.
Status FillDrawings(const arap_flatten_options& given, client::FlattenQuery& query);
// Belongs to the caller.
arap_flat* FlatOf(client::FlatSurface&& flat);

}  // namespace arap::c
