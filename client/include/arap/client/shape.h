// Deformed meshes: what to ask for and what comes back.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "arap/model/deform.h"
#include "arap/model/encoding.h"

namespace arap::client {

using arap::DeformMode;
using arap::DeformOptions;
using arap::Pick;
using arap::PositionEncoding;
using arap::ShapeQuality;

// How to deform, and how to answer.
struct ShapeOptions {
  DeformOptions deform = {};
  // Positions in double precision on the wire. Else they are relative to the middle of the shape, so
  // that they are as exact at map coordinates as at 0: off by 6e-8 of half the size of the shape at
  // most, or by what `encoding` says.
  bool float64 = false;
  bool flipped_ids = false;  // also the ids of flipped triangles, of shapes that are measured
  // How positions travel; not with float64. kInt16Le takes half the bytes of the others and is off by
  // up to 1/131068 of the longer side of the box around the shape.
  PositionEncoding encoding = PositionEncoding::kFloat32;
  // Only the positions of some vertices: those on the boundary by ascending index, or these in this
  // order, none of them twice. Not both.
  bool boundary_only = false;
  std::vector<std::uint32_t> vertex_subset = {};
};

// A deformed mesh and how good it is.
struct Shape {
  std::vector<Complex> positions;  // #V, or as many as `vertices`; units of the mesh
  std::vector<std::uint32_t>
      vertices;               // which they are of, when not all were asked for; else empty
  double position_error = 0;  // how far a coordinate may be off by its way over the wire
  // Whether it was measured, quality.measured says. quality.worst_handle is 0: the server names the
  // handle with the worst error, by its id.
  ShapeQuality quality;
  std::string worst_handle_id;             // empty without handles
  std::vector<std::uint32_t> flipped_ids;  // when asked
  std::vector<std::optional<Pick>> picks;  // one per picked point; empty where nothing lies
  std::uint64_t sequence = 0;              // of the update that it answers, or the frame's index
  std::uint64_t replaced = 0;              // updates that newer ones replaced since the last answer
  std::uint64_t handle_set_revision = 0;   // of the handle set that made this shape
  double queue_micros = 0;                 // time that the update waited for a worker
  double solve_micros = 0;                 // time that it took to compute
};

}  // namespace arap::client
