// Flattening of surfaces: what to ask for and what comes back.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "arap/client/energy.h"
#include "arap/client/mesh.h"

namespace arap::client {

struct FlattenOptions {
  EnergyOptions energy;          // Basis::kVertex is not for surfaces
  std::uint32_t refine = 0;      // local/global iterations after the two steps, up to max_refine
  bool first_step = false;       // also answer the result of the first step
  bool singular_values = false;  // also answer s1 and s2 of every triangle
  bool float64 = false;          // uv in double precision on the wire, else single
  std::vector<std::uint32_t> seam_edges;  // vertex pairs a b a b… to cut along first
};

// How far a mapping is from an isometry; s1 >= s2 are the singular values of a triangle's Jacobian.
// Means are weighted with the areas in space.
struct Distortion {
  double arap_energy = 0;          // of (s1 − 1)² + (s2 − 1)², relative to the area
  double symmetric_dirichlet = 0;  // of s1² + s2² + s1⁻² + s2⁻²; 4 for an isometry
  double area_ratio = 0;           // flat area / area in space
  double mean_stretch_percent = 0, max_stretch_percent = 0;          // of max(0, s1 − 1)
  double mean_compression_percent = 0, max_compression_percent = 0;  // of max(0, 1 − s2)
  double mean_angle_degrees = 0, max_angle_degrees = 0;  // largest change of a corner angle
  std::uint64_t flipped = 0;                             // triangles whose orientation is reversed
  double scale = 1;                                      // applied to the answer
};

// A flat surface, true to size: uv in the units of the input.
struct FlatSurface {
  std::vector<double> uv;                // u v u v…, length 2·#U; #U > #V where seams were cut
  std::vector<std::uint32_t> uv_vertex;  // the input vertex of each flat position, length #U
  std::vector<std::uint32_t> corner_uv;  // the flat position of each triangle corner, length 3·#F
  std::vector<double> first_step_uv;     // length 2·#U, when asked
  std::vector<double> singular_values;   // s1 s2 s1 s2…, length 2·#F, when asked
  Distortion distortion;
  std::vector<Warning> warnings;
  std::vector<std::uint32_t> anchor_vertices;  // the centre edge
  double queue_micros = 0;
  double solve_micros = 0;
};

}  // namespace arap::client
