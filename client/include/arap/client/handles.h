// Handles and their compilation: places of a mesh that the caller moves, and where they should go.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "arap/client/mesh.h"
#include "arap/model/handle.h"

namespace arap::client {

using arap::Handle;
using arap::HandleTarget;
using arap::Outside;
using arap::PlacedHandle;
using arap::PointAnchor;
using arap::Target;
using arap::TriangleAnchor;
using arap::VertexAnchor;

// A handle set as a session holds it.
struct HandleSetInfo {
  std::string id;
  std::string mesh_id;
  // As the server placed them, in the order of `positions` of an update. Of `handle` the id is set
  // and nothing else.
  std::vector<PlacedHandle> handles;
  std::uint64_t row_count = 0;  // constraint rows: the size of the dense system
  std::uint64_t bytes = 0;      // held beside the mesh
  std::vector<Warning> warnings;
  std::vector<double> depth;                 // per vertex, length 0 or #V
  std::vector<std::uint32_t> draw_order;     // triangles back to front, length 0 or #F
  std::uint64_t revision = 0;                // grows by one with every edit
  std::uint64_t resting_components = 0;      // components without a handle, which stay at rest
  std::uint64_t translating_components = 0;  // components with one distinct handle
};

// The answer to CompileHandles and EditHandles.
struct Compilation {
  HandleSetInfo handle_set;
  double queue_micros = 0;  // time spent waiting for a worker
  double solve_micros = 0;  // time spent computing
};

}  // namespace arap::client
