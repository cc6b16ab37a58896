// Stretch: how far the triangles of a deformed shape are from rigid, and which ones are flipped.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "arap/base/crew.h"
#include "arap/model/mesh.h"

namespace arap {

// Stretch of the triangles of a planar mesh under a deformation. Built once per mesh, then
// immutable.
class StretchTable {
 public:
  StretchTable() = default;
  StretchTable(const PlanarMesh& mesh, const std::vector<Complex>& rest);

  struct Stretch {
    std::size_t flipped = 0;
    double mean = 1, max = 1;
  };
  // `positions` (#V) in units of the mesh; `diagonal` takes them to the normalised rest shape. The same
  // bytes with a crew and without.
  Stretch Measure(const PlanarMesh& mesh, std::span<const Complex> positions, double diagonal,
                  Crew* crew = nullptr) const;

  // The map of a triangle is z ↦ αz + βz̄ with α = a1 E1 + a2 E2 and β = ā1 E1 + ā2 E2, where E1, E2
  // are its deformed edge vectors. Its singular values are |α| ± |β|. Columns, #F.
  struct Columns {
    std::vector<double> a1_x, a1_y, a2_x, a2_y;
    std::vector<double> area;  // as a fraction of the whole
  };

 private:
  Columns columns_;
};

// Whether a triangle of `positions` runs clockwise.
bool IsFlipped(const Triangle& triangle, std::span<const Complex> positions);

}  // namespace arap
