// The tables of a RegisteredMesh, for this folder only, and places in the triangles that the client sent,
// where repairs have made others of them.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "arap/core/registered_mesh.h"
#include "core/deform/stretch.h"
#include "core/deform/vertex_runs.h"
#include "core/energy/cells.h"
#include "core/mesh/locate.h"
#include "core/mesh/repair.h"
#include "core/mesh/topology.h"
#include "core/sparse/factor.h"

namespace arap {

// Below this fraction of the diagonal two rest points are one.
inline constexpr double kCoincident = 1e-9;

struct MeshComponent {
  Complex center;  // of its bounding box, normalised
  // Fixed in both steps: near the centre, where |Z| stays small.
  std::uint32_t ground0 = kNone;
  // Fixed in step 1 too: a quarter of the component's diagonal away.
  std::uint32_t ground1 = kNone;
};

struct RegisteredMeshParts {
  // Normalised = (input − origin) / diagonal: no result depends on the unit or the place.
  Complex Normalise(Complex p) const { return (p - origin) / report.diagonal; }

  // Triangles as they were given, before repairs.
  std::size_t given_triangles() const {
    return repair.changed() ? repair.given.size() : mesh.triangles.size();
  }

  PlanarMesh mesh;           // mended: #V as given, #F as they are used
  std::vector<bool> turned;  // #F, triangles whose corners 1 and 2 were swapped
  RepairOptions repairs;
  Repair repair;
  EnergyOptions options;
  RegistrationReport report;
  Topology topology;
  std::vector<std::uint32_t> nearby;  // #F, NearbyOrder of the rest shape
  Complex origin;
  std::vector<Complex> rest;    // #V, normalised
  std::vector<VertexRun> runs;  // of topology.vertex_component
  std::vector<MeshComponent> components;
  Cells cells;
  StretchTable stretch;
  // Of step 1, two vertices of a component grounded, and of step 2, one grounded.
  std::shared_ptr<const Factor<Complex>> similarity;
  std::shared_ptr<const Factor<double>> rigid;
};

// Where a point of a given triangle is in the registered mesh, in the order of the registered triangle.
// One that collapsed is where its heaviest corner is; kNone when that is in no triangle. O(#F) for such,
// else O(log #F).
Located FromGiven(const RegisteredMeshParts& mesh, std::uint32_t given,
                  const std::array<double, 3>& barycentric);

// A point of a registered triangle as one of the given triangle that it belongs to, in the order in which
// that was sent.
Located ToGiven(const RegisteredMeshParts& mesh, const Located& place);

}  // namespace arap
