// How a mesh becomes an energy.
#pragma once

#include <vector>

namespace arap::client {

// What a cell is: the piece of the mesh that has one rotation.
enum class Basis {
  kDefault,          // the server's choice, which is kEdge
  kEdge,             // an edge with its two opposite vertices; independent of the vertex numbering
  kEdgeAsPublished,  // the same relative to its lower vertex, as the method was published
  kFace,             // a triangle; best when refining
  kVertex,           // a vertex with its spokes; planar meshes only
};

// How much an edge counts.
enum class EdgeWeights {
  kDefault,    // uniform for deformation, cotangent for flattening
  kUniform,    // every edge the same
  kCotangent,  // independent of the triangulation
};

struct EnergyOptions {
  Basis basis = Basis::kDefault;
  EdgeWeights weights = EdgeWeights::kDefault;
  std::vector<double> rigidity;  // per triangle, length 0 or #F, 0 < r <= 1e6; 1 is neutral
};

}  // namespace arap::client
