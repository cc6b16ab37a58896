// The paper transcribed with dense real matrices: slow, plain, and the judge of the core.
//
// Rows of A1 and A2 stand as in [II09 §4] and each system is solved in the least-squares sense by a
// dense QR factorisation, never through normal equations. Fine up to some hundred vertices.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "arap/model/energy.h"
#include "arap/model/mesh.h"
#include "tests/support/hinges.h"

namespace arap::testing {

// One row of constraints: Σ weights·vertices = target. A vertex handle is {{v, v, v}, {1, 0, 0}}.
struct TextbookHandle {
  std::array<std::uint32_t, 3> vertices{};
  std::array<double, 3> weights{};
  double weight = 1e6;  // on the squared residual; the paper's w = 1000 multiplies the row
};

// §4 and §5. `targets` has one entry per handle; every component needs two distinct handles.
// Vertices without triangles stay at rest. `first_step` receives the result of the first step.
std::vector<Complex> TextbookDeform(const PlanarMesh& mesh, bool both_directions, Weights weights,
                                    std::span<const TextbookHandle> handles,
                                    std::span<const Complex> targets,
                                    std::vector<Complex>* first_step = nullptr,
                                    Slip slip = Slip::kNone);

// §7. The first step holds vertex a at 0 and vertex b at |b − a|, exactly; the second holds a only.
std::vector<Complex> TextbookFlatten(const SurfaceMesh& mesh, bool both_directions, Weights weights,
                                     std::uint32_t a, std::uint32_t b,
                                     std::vector<Complex>* first_step = nullptr,
                                     Slip slip = Slip::kNone);

}  // namespace arap::testing
