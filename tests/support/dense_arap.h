// The local/global iteration of as-rigid-as-possible mapping with one rotation per triangle and
// cotangent weights, in dense matrices: the judge of FACE cells with refinement.
//
// The energy is Σ over triangles and their edges of ½cot(opposite angle)·|(v_b − v_a) − R_t(p_b −
// p_a)|², plus weight·|C v − target|² per handle. Cotangents are not clamped.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "arap/model/mesh.h"
#include "tests/support/textbook.h"

namespace arap::testing {

// Triangles with the rest shape of each in a frame of its own.
struct FaceCells {
  std::size_t vertices = 0;
  std::vector<Triangle> triangles;
  std::vector<std::array<Complex, 3>> rest;
};
FaceCells CellsOf(const PlanarMesh& mesh);
FaceCells CellsOf(
    const SurfaceMesh& mesh);  // laid flat: first corner at 0, second at +x, third above

// Energy of the shape with the best rotation in every triangle, handles left out. Squared units.
double FaceEnergy(const FaceCells& cells, std::span<const Complex> shape);

struct DenseArapResult {
  std::vector<Complex> positions;
  double energy = 0;        // FaceEnergy of positions
  double total_energy = 0;  // with the handles
};

// `iterations` times: best rotations, then best positions. Without handles the centroid stays where
// it is. Vertices without triangles stay where `start` has them.
// The normal equations are solved as they stand: with handle weights of 1e6 good to about 1e-9.
DenseArapResult DenseArap(const FaceCells& cells, std::span<const TextbookHandle> handles,
                          std::span<const Complex> targets, std::span<const Complex> start,
                          int iterations);

}  // namespace arap::testing
