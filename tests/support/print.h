// How the values of parameterised tests are called in the names and messages of tests.
#pragma once

#include <ostream>

#include "arap/model/energy.h"

namespace arap {

inline const char* NameOf(Basis basis) {
  switch (basis) {
    case Basis::kEdge:
      return "edge";
    case Basis::kEdgeAsPublished:
      return "edge_as_published";
    case Basis::kFace:
      return "face";
    case Basis::kVertex:
      return "vertex";
  }
  return "?";
}
inline const char* NameOf(Weights weights) {
  return weights == Weights::kUniform ? "uniform" : "cotangent";
}

// GoogleTest finds these by their names.
inline void PrintTo(Basis basis, std::ostream* out) { *out << NameOf(basis); }
inline void PrintTo(Weights weights, std::ostream* out) { *out << NameOf(weights); }

}  // namespace arap
