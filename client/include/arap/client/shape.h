// Deformed meshes: what to ask for and what comes back.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace arap::client {

// What to minimise.
enum class DeformMode {
  kRigid,       // both steps: as rigid as possible
  kSimilarity,  // the first step alone: free to scale
  kBaseline,    // without rotation: edge vectors keep their rest directions
};

struct DeformOptions {
  DeformMode mode = DeformMode::kRigid;
  std::uint32_t refine = 0;  // iterations of the second step from its own result, up to max_refine
  bool float64 = false;      // positions in double precision on the wire, else single
  bool flipped_ids = false;  // also answer the ids of flipped triangles
};

// Where a deformed point was at rest.
struct PickResult {
  bool hit = false;  // whether the point lies in a deformed triangle; the rest is void otherwise
  std::uint32_t triangle = 0;
  double rest_x = 0, rest_y = 0;  // units of the mesh
  std::array<double, 3> barycentric{};
};

// A deformed mesh and how good it is.
struct Shape {
  std::vector<double> positions;  // x y x y…, length 2·#V; float values unless float64 was asked
  std::uint64_t sequence = 0;     // of the update that it answers; in a track, the frame index
  std::uint64_t replaced = 0;     // updates that newer ones replaced since the answer before
  std::uint64_t flipped_count = 0;         // triangles whose orientation is reversed
  std::vector<std::uint32_t> flipped_ids;  // when asked
  double worst_handle_error = 0;           // largest distance of a handle from its target
  std::string worst_handle_id;
  double energy = 0;              // of the basis, handles left out; without unit
  double mean_stretch = 1;        // area-weighted mean of the larger of s1 and 1/s2
  double max_stretch = 1;         // largest of them; 1 for a rigid motion
  double queue_micros = 0;        // time that the update waited for a worker
  double solve_micros = 0;        // time that it took to compute
  std::vector<PickResult> picks;  // one per picked point
  std::uint64_t handle_set_revision = 0;
};

// One frame of a track: columns are the handle ids of the call.
struct TrackFrame {
  std::vector<double> positions;       // x y x y…, length 2·#handles, units of the mesh
  std::vector<double> angles_radians;  // length 0 or #handles
  std::vector<double> scales;          // length 0 or #handles
};

}  // namespace arap::client
