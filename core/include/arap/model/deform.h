// Deformation: what to ask for, how good a shape is, where a point of it was at rest.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "arap/model/mesh.h"

namespace arap {

// What to minimise.
enum class DeformMode {
  kRigid,       // both steps
  kSimilarity,  // the first step alone: free to scale (Fig. 2 middle)
  kBaseline,    // eq. 1: edge vectors keep their rest directions
};

inline constexpr int kMaxRefine = 1000;

struct DeformOptions {
  DeformMode mode = DeformMode::kRigid;
  // Repetitions of the second step with the rotations of its own result, 0 to kMaxRefine; in
  // kRigid only. A descent for FACE and VERTEX cells, not for EDGE cells [algorithm §1].
  int refine = 0;
  // Which shapes of a stream or track are measured (ShapeQuality): the first, and every n-th after
  // one that was; 1 all, 0 none. Measuring takes about a quarter of a frame.
  std::uint32_t measure_every = 1;

  bool operator==(const DeformOptions&) const = default;
};

// How good a shape is. Of one that was not measured only the handle that misses most is told.
struct ShapeQuality {
  std::size_t flipped = 0;        // triangles with reversed orientation
  double worst_handle_error = 0;  // units of the mesh
  std::size_t worst_handle = 0;   // its index; 0 without handles
  double energy = 0;              // of the basis, normalised to a unit diagonal, without handles
  double mean_stretch = 1;        // area-weighted mean of max(s1, 1/s2) over triangles
  double max_stretch = 1;         // at most 1e30
  bool measured = true;           // else flips, energy and stretch are as above, which says nothing

  bool operator==(const ShapeQuality&) const = default;
};

// Where a point of a deformed shape was at rest.
struct Pick {
  std::uint32_t triangle = 0;
  std::array<double, 3> barycentric{};  // in the order of the triangle as it was sent
  Complex rest;                         // units of the mesh

  bool operator==(const Pick&) const = default;
};

}  // namespace arap
