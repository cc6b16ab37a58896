// What flattening and its jobs share for C.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "client/c/objects.h"

// NOLINTBEGIN(readability-identifier-naming): the names of C.
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

Result<client::SurfaceMesh> SurfaceOf(const double* vertices, std::size_t vertex_count,
                                      const std::uint32_t* triangles, std::size_t triangle_count);
Result<client::FlattenQuery> QueryOf(const arap_flatten_options& given, std::size_t triangles);
// The drawings and parts of a query.
Status FillDrawings(const arap_flatten_options& given, client::FlattenQuery& query);
// Belongs to the caller.
arap_flat* FlatOf(client::FlatSurface&& flat);

}  // namespace arap::c
