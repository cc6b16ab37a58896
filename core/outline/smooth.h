// Smoothing of meshes of the plane.
#pragma once

#include <vector>

#include "arap/model/mesh.h"

namespace arap {

// The smallest angle of a triangle, degrees; 0 or less when it is not counter-clockwise.
double SmallestAngle(Complex a, Complex b, Complex c);

// Moves the vertices that are not `fixed` towards the middle of their neighbours, a few times,
// where no angle round them falls below 28 degrees or below what the smallest was. O(#F).
void Smooth(const std::vector<bool>& fixed, PlanarMesh& mesh);

}  // namespace arap
