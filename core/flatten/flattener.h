// Flattening: a disk-like surface laid in the plane, as rigidly as possible [II09 §7].
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/cancel.h"
#include "core/base/result.h"
#include "core/energy/options.h"
#include "core/flatten/distortion.h"
#include "core/mesh/mesh.h"
#include "core/mesh/validation.h"

namespace arap {

struct FlattenOptions {
  EnergyOptions energy{Basis::kEdge, Weights::kCotangent, {}};
  int refine =
      0;  // local/global iterations with FACE cells and cotangent weights; 0…kMaxFlattenRefine
  MeshLimits limits;
};

inline constexpr int kMaxFlattenRefine = 1000;

struct Flattening {
  std::vector<Complex> first_step;  // #V, after the first step (Fig. 6a); unit of the input
  std::vector<Complex> uv;          // #V, the answer; true to size
  std::vector<std::array<double, 2>> singular_values;  // #F, s1 >= |s2|, s2 negative when flipped
  Distortion distortion;                               // of uv
  std::array<std::uint32_t, 2> anchors{};              // the centre edge that fixes the first step
  std::vector<Warning> warnings;
  std::vector<Triangle> triangles;  // as flattened: turned to agree
};

// Stateless, thread-safe. Faults: those of ValidateSurface, kNotADisk (which says what it is
// instead), kInvalidOption, kNumerical, and whatever `cancel` answers between the phases.
// Unreferenced vertices get the uv (0, 0) and a warning.
Result<Flattening> Flatten(SurfaceMesh mesh, const FlattenOptions& options,
                           const CancelToken& cancel = {});

}  // namespace arap
