// The machine codes of the local step give the same bytes, and what they compute is the sum
// that algorithm §1 writes.
#include "core/energy/local_step.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "core/energy/assemble.h"
#include "core/energy/cells.h"
#include "tests/support/meshes.h"

namespace arap {
namespace {

struct Case {
  PlanarMesh mesh;
  Cells cells;
  std::vector<Complex> shape;
  const double* Numbers() const { return reinterpret_cast<const double*>(shape.data()); }
};

Case MakeCase(Basis basis, std::uint64_t seed) {
  Case c;
  c.mesh = testing::JitteredGrid(23, 17, seed);
  const Topology topology = BuildTopology(c.mesh.vertices.size(), c.mesh.triangles);
  const auto frame = [&](std::uint32_t t) -> std::array<Complex, 3> {
    const Triangle& k = c.mesh.triangles[t];
    return {c.mesh.vertices[k[0]], c.mesh.vertices[k[1]], c.mesh.vertices[k[2]]};
  };
  c.cells =
      BuildCells(c.mesh.triangles, topology, {basis, Weights::kCotangent, {}}, frame, true)->cells;
  for (const Complex p : c.mesh.vertices) {
    const Complex q = p * Complex(0.3, 0.9) + 0.1 * std::sin(7 * p.real()) + p * p * 0.01;
    c.shape.push_back(q);
  }
  // A triangle and its neighbours that fall into one point: no direction.
  for (const std::uint32_t v : c.mesh.triangles[40]) c.shape[v] = c.shape[0];
  return c;
}

bool SameBytes(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}
bool SameBytes(const KernelColumn& a, const KernelColumn& b, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) {
    if (!SameBytes(a[k], b[k])) return false;
  }
  return true;
}

// Calls compare(begin, count) for blocks of every length of a table.
template <class Compare>
void ForEveryLength(std::size_t size, Compare compare) {
  for (std::size_t at = 0, count = 1; at < size; at += count, ++count) {
    compare(at, std::min({count, kKernelBlock, size - at}));
  }
}

TEST(LocalKernels, EveryMachineCodeGivesTheSameBytes) {
  const std::span<const LocalKernels> all = LocalKernelsHere();
  if (all.size() == 1) GTEST_SKIP() << "this processor has only the plain code";
  const LocalKernels& plain = all.front();
  const Complex mean(0.6, -0.8);
  for (const LocalKernels& other : all.subspan(1)) {
    ASSERT_NE(other.hinge_forces, plain.hinge_forces);
    for (const Basis basis : {Basis::kEdge, Basis::kEdgeAsPublished}) {
      const Case c = MakeCase(basis, 5);
      const HingeTable& table = c.cells.hinges;
      ForEveryLength(table.size(), [&](std::size_t at, std::size_t count) {
        KernelColumn x{}, y{}, p{}, q{};
        other.hinge_forces(table, at, count, c.Numbers(), mean, mean, x, y);
        plain.hinge_forces(table, at, count, c.Numbers(), mean, mean, p, q);
        EXPECT_TRUE(SameBytes(x, p, count) && SameBytes(y, q, count)) << at;
        double energy = 0, expected = 0;
        other.hinge_energy(table, at, count, c.Numbers(), energy);
        plain.hinge_energy(table, at, count, c.Numbers(), expected);
        EXPECT_TRUE(SameBytes(energy, expected)) << at;
      });
    }
    const Case c = MakeCase(Basis::kFace, 6);
    const FaceTable& table = c.cells.faces;
    ForEveryLength(table.size(), [&](std::size_t at, std::size_t count) {
      KernelColumn x1{}, y1{}, x2{}, y2{}, p1{}, q1{}, p2{}, q2{};
      other.face_forces(table, at, count, c.Numbers(), mean, mean, x1, y1, x2, y2);
      plain.face_forces(table, at, count, c.Numbers(), mean, mean, p1, q1, p2, q2);
      EXPECT_TRUE(SameBytes(x1, p1, count) && SameBytes(y1, q1, count)) << at;
      EXPECT_TRUE(SameBytes(x2, p2, count) && SameBytes(y2, q2, count)) << at;
      double energy = 0, expected = 0;
      other.face_energy(table, at, count, c.Numbers(), energy);
      plain.face_energy(table, at, count, c.Numbers(), expected);
      EXPECT_TRUE(SameBytes(energy, expected)) << at;
    });
  }
}

TEST(LocalKernels, ForceEnergyAndMatrixAgree) {
  for (const Basis basis : {Basis::kEdge, Basis::kEdgeAsPublished, Basis::kFace, Basis::kVertex}) {
    Case c = MakeCase(basis, 7);
    // In a turned rest shape every t̂ is that turn: the energy is 0, and Σ w t̂ e is what the matrix
    // of the same energy makes of the shape.
    const Complex turn = std::polar(1.0, 0.7);
    for (std::size_t v = 0; v < c.mesh.vertices.size(); ++v) {
      c.shape[v] = turn * c.mesh.vertices[v];
    }
    EXPECT_LT(RigidEnergy(c.cells, c.shape), 1e-20 * static_cast<double>(c.shape.size()));
    const std::vector<Complex> none(1, 0);
    std::vector<Complex> force(c.shape.size());
    AddRotatedEdges(c.cells, c.shape, none, force);
    const Eigen::SparseMatrix<double> laplacian =
        AssembleRigid(c.cells, std::vector<bool>(force.size(), false));
    const Eigen::SparseMatrix<double> whole = laplacian.selfadjointView<Eigen::Lower>();
    const Eigen::VectorXcd x = Eigen::Map<const Eigen::VectorXcd>(
        c.shape.data(), static_cast<Eigen::Index>(c.shape.size()));
    const Eigen::VectorXcd expected = whole.cast<Complex>() * x;
    for (std::size_t v = 0; v < force.size(); ++v) {
      EXPECT_LT(std::abs(force[v] - expected[static_cast<Eigen::Index>(v)]), 1e-10);
    }
  }
}

}  // namespace
}  // namespace arap
