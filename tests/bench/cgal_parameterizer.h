// CGAL's parameterizers of a disk-like surface, for comparison. Optional: without CGAL there is
// nothing to run.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "arap/model/mesh.h"

namespace arap::bench {

enum class CgalMethod { kLscm, kArap };

// A surface as CGAL wants it, and CGAL's own defaults: LSCM with a simplicial LDLᵗ, ARAP with
// sparse LU, λ = 1000 and at most 50 iterations.
class CgalParameterizer {
 public:
  static bool Available();
  // `mesh` must be a disk.
  explicit CgalParameterizer(const SurfaceMesh& mesh);
  ~CgalParameterizer();
  CgalParameterizer(const CgalParameterizer&) = delete;
  CgalParameterizer& operator=(const CgalParameterizer&) = delete;

  // Empty, or what CGAL says went wrong.
  std::string Run(CgalMethod method);
  std::vector<Complex> uv() const;  // #V

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace arap::bench
