// The deformation scheme as its paper implements it, for comparison [II09 §4, §6].
//
// The handles' rows stand in both step matrices, so every change of the handle set factors them
// again: a real 2#V×2#V matrix for the first step, a #V×#V one for the second. A frame is two
// right-hand sides and two back-substitutions. Done as well as it can be: CHOLMOD, the ordering
// found once per mesh (the handles' entries lie inside the pattern), kept workspaces, one table
// entry per edge.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/SparseCore>

#include "arap/model/mesh.h"
#include "tests/bench/penalty_system.h"

namespace arap::bench {

// Σ weights·vertices should lie at the target; the three vertices are those of a triangle.
struct PaperHandle {
  std::array<std::uint32_t, 3> vertices{};
  std::array<double, 3> weights{};
};

// EDGE cells as published, uniform edge weights. Every component needs two distinct handles. Aborts
// when a factorisation fails. Not thread-safe.
class PaperScheme {
 public:
  static constexpr double kWeight = 1e6;  // of a handle's squared miss: the paper's w = 1000

  // "Registration": the edges' fits and both matrices without handles.
  explicit PaperScheme(const PlanarMesh& mesh);
  // "Compilation": adds the handles' rows and factors.
  void Compile(std::span<const PaperHandle> handles);
  // "Interactive update": one target per handle; the shape (#V) is valid until the next call.
  std::span<const Complex> Update(std::span<const Complex> targets);

  std::size_t bytes() const;  // held by factors, matrices and tables

 private:
  // (c, s) = (Σ a x + b y, Σ b x − a y) over the vertices: row by row (GᵗG)⁻¹Gᵗ. Vertices 0 and 1
  // are the edge; where there is no fourth vertex, vertex 0 stands in with coefficients 0.
  struct EdgeFit {
    std::array<std::uint32_t, 4> vertices{};
    std::array<double, 4> a{}, b{};
    double x = 0, y = 0;  // the edge at rest
  };

  void AddFit(const PlanarMesh& mesh, std::span<const std::uint32_t> vertices);
  Eigen::SparseMatrix<double> FirstMatrix() const;
  Eigen::SparseMatrix<double> SecondMatrix() const;
  void TurnEdges(const double* shape);

  std::size_t vertices_;
  std::vector<EdgeFit> fits_;
  std::vector<PaperHandle> handles_;
  std::unique_ptr<PenaltySystem> first_, second_;
  std::vector<double> first_right_;   // x0 y0 x1 y1 …
  std::vector<double> second_right_;  // all x, then all y
  std::vector<Complex> shape_;
};

}  // namespace arap::bench
