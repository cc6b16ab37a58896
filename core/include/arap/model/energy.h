// What energy to build: the basis, the edge weights, the rigidity.
#pragma once

#include <vector>

namespace arap {

// What a cell is: the piece of the mesh that has one rotation [algorithm §1].
enum class Basis {
  kEdge,             // one cell per directed edge with its opposite vertices, half weight each
  kEdgeAsPublished,  // one per edge, from the lower to the higher index [II09 §4.2]
  kFace,             // one per triangle; best when refining
  kVertex,           // one per vertex, planar meshes only
};

// How much an edge counts.
enum class Weights {
  kUniform,    // every edge the same
  kCotangent,  // by the angles opposite of it: the energy depends little on the triangulation
};

struct EnergyOptions {
  Basis basis = Basis::kEdge;
  Weights weights = Weights::kUniform;
  // How stiff every triangle is (#F), above 0 and at most kMaxRigidity; it multiplies the weights
  // of its edges. Empty: 1 everywhere.
  std::vector<double> rigidity;

  bool operator==(const EnergyOptions&) const = default;
};

inline constexpr double kMaxRigidity = 1e6;

// The smallest cotangent weight that EDGE and VERTEX cells accept; smaller and negative ones are
// raised to it and counted, because those energies need positive weights.
inline constexpr double kMinCotangent = 1e-3;

}  // namespace arap
