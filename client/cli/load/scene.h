// Scene: what the streams of a load generator move, and where.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "arap/base/result.h"
#include "arap/client/handles.h"
#include "arap/client/mesh.h"
#include "arap/client/shape.h"
#include "client/cli/load/chance.h"

namespace arap::cli {

// The same for every stream: the server factors the mesh once.
struct LoadScene {
  PlanarMesh mesh;
  std::vector<Handle> handles;
  std::vector<Complex> rests;  // of the handles
  double reach = 0;            // how far a target strays from its rest position
  Handle extra;                // what edits add and take away again
  SurfaceMesh surface;         // the mesh on a cylinder, to be flattened
};

// A grid of about `vertices` vertices with `handles` handles spread over it.
LoadScene MakeLoadScene(std::size_t vertices, std::size_t handles);
// The mesh of a file, in any plane and of any format, with so many vertices of it as handles, as far
// apart as it goes; with a track file, its handles. Faults as ReadPlanarMesh and ReadTrack have;
// kInvalidOption for more handles than vertices and for a mesh without a triangle.
Result<LoadScene> ReadLoadScene(const std::string& mesh_file, std::size_t handles,
                                const std::string& handles_file);
// The scene with the handles of a track file.
Status TakeHandles(const std::string& handles_file, LoadScene& scene);

// Where the handles go at the `step`-th update of a stream: each round its rest position, at its own
// phase, one stream unlike the other. The same seed gives the same targets.
std::vector<Complex> TargetsOf(const LoadScene& scene, std::uint64_t seed, std::size_t stream,
                               std::uint64_t step);

}  // namespace arap::cli
