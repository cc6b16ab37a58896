// What the comparisons work on: a mesh, handles on it, poses to go through.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "arap/model/handle.h"
#include "arap/model/mesh.h"

namespace arap::bench {

struct Scene {
  std::string name;
  PlanarMesh mesh;
  std::vector<Handle> handles;  // points inside triangles, far from one another
  Handle extra;                 // one more, to add
  // One position per handle (`extra` is not among them); each handle goes round in a circle.
  std::vector<std::vector<Complex>> poses;
};

// About that many vertices; the same arguments give the same scene.
Scene GridScene(std::size_t vertices);
Scene CharacterScene(std::size_t vertices);

// The three vertices that hold a handle of a scene, with their weights.
struct Hold {
  Triangle vertices;
  std::array<double, 3> weights;
};
Hold HoldOf(const Scene& scene, const Handle& handle);

}  // namespace arap::bench
