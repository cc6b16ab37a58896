// How good a layout is, in one way for everybody's.
#pragma once

#include <span>

#include "arap/core/flattener.h"
#include "arap/model/mesh.h"

namespace arap::bench {

struct LayoutQuality {
  Distortion distortion;
  // The ARAP energy at the size that makes it least: fair to layouts without a size of their own.
  double scaled_energy = 0;
};

LayoutQuality QualityOf(const SurfaceMesh& mesh, const Flattening& flat);
// One position per vertex; a layout that is mostly mirrored is turned over first.
LayoutQuality QualityOf(const SurfaceMesh& mesh, std::span<const Complex> uv);

}  // namespace arap::bench
