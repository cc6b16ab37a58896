// Hinge: an edge with its one or two opposite vertices, laid out in the plane [II09 Fig. 4, Fig.
// 5].
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "arap/model/energy.h"
#include "arap/model/mesh.h"

namespace arap::testing {

// The mistakes of the printed paper that can be made on purpose [algorithm §7].
enum class Slip {
  kNone,
  kAbsoluteFit,        // eq. 3: the fit takes positions instead of differences from v_i
  kSquaredNormaliser,  // after eq. 6: 1/(c²+s²) instead of its root
  kSameSide,           // §7: d' above the edge, where c' is
  kBoundaryAbove,      // §7: the only opposite vertex of a boundary edge always above
};

struct Hinge {
  std::vector<std::uint32_t> vertices;  // i, j, then l and r as far as they exist
  std::vector<Eigen::Vector2d> rest;    // their positions in the hinge's own frame
  double weight = 1;                    // on the squared residual
};

// One hinge per edge from the lower to the higher index, or one per directed edge with half the
// weight.
std::vector<Hinge> PlanarHinges(const PlanarMesh& mesh, bool both_directions, Weights weights);

// The same for a surface: i at the origin, j on the positive x axis, the triangle that runs i→j
// above, the one that runs j→i below. `slip` may be kSameSide or kBoundaryAbove.
std::vector<Hinge> UnfoldedHinges(const SurfaceMesh& mesh, bool both_directions, Weights weights,
                                  Slip slip);

}  // namespace arap::testing
