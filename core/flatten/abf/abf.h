// Angle-based flattening: the flat angles of a surface, found before its positions.
//
// The angles closest to those of the surface (relative change, least squares) that fit together in
// the plane: they sum to π in every triangle and to 2π around every interior vertex, and walking
// round an interior vertex comes back to the edge length it started from (Σ log sin of the angles
// after it − Σ log sin of those before it = 0). Sheffer et al., ABF++, ACM Trans. Graph. 24(2),
// 2005; linearised as by Zayer, Lévy and Seidel, SGP 2007, and repeated as Newton steps.
#pragma once

#include <array>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/model/mesh.h"
#include "core/mesh/topology.h"

namespace arap {

// One angle per corner of a triangle, radians.
using TriangleAngles = std::array<double, 3>;

// Smooth surfaces are done after 3 to 5 steps, rough ones after 10; only crumpled ones take more.
inline constexpr int kMaxAngleSteps = 40;

// How far angles are from fitting together in the plane: the largest error of an angle sum (of a
// triangle or around an interior vertex, radians) and of a sum of log sines around an interior
// vertex. Angles must be in (0, π). O(#F).
struct AngleResidual {
  double sum = 0;
  double wheel = 0;
};
AngleResidual ResidualOf(const std::vector<Triangle>& triangles, const Topology& topology,
                         const std::vector<TriangleAngles>& angles);

// Flat angles of `mesh` (#F), each strictly between 0 and π, every triangle's summing to π. The
// mesh must be valid and its triangles oriented alike; every component needs a boundary. Holes and
// handles are allowed, but nothing makes the way around them close: positions found from the angles
// then fit them in the least-squares sense only, and may be no better than LSCM's. The angles of
// the surface are first scaled to sum to 2π around each interior vertex; a corner that this would
// open beyond a straight angle is clamped.
//
// Triangles in `left_out` (#F or empty) have no angles of their own: they get equal ones, and
// around their corners nothing has to fit.
//
// `steps` is 1 for the linearised method and more for Newton steps, which end early when the angles
// fit. A step that would turn a corner inside out is shortened in that triangle, and the corner
// gives way less in later steps. When the steps end without success (a surface crumpled so that
// most angles change several times over) the angles with the least residual are returned: positions
// found from them are still well defined, only less conformal. Ask ResidualOf.
//
// Cost: per step a factorisation of 2 unknowns per interior vertex. Deterministic, thread-safe.
// Faults: kNotADisk (a closed component), kInvalidOption (steps), kNumerical, and what `cancel`
// answers between the steps.
Result<std::vector<TriangleAngles>> FlatAngles(const SurfaceMesh& mesh, const Topology& topology,
                                               const CancelToken& cancel = {},
                                               int steps = kMaxAngleSteps,
                                               const std::vector<bool>& left_out = {});

// A triangle with these angles (positive, summing to π): the first corner at 0, the second at
// `length` on the positive real axis, the third above.
std::array<Complex, 3> FrameOfAngles(const TriangleAngles& angles, double length);

}  // namespace arap
