// The two machine codes of the local step give the same bytes, and what they compute is the sum
// that algorithm §1 writes.
#include "core/energy/local_step.h"

#include <bit>
#include <cmath>

#include <gtest/gtest.h>

#include "core/base/wide.h"
#include "core/energy/assemble.h"
#include "core/energy/cells.h"
#include "tests/support/meshes.h"

namespace arap {
namespace {

struct Shape {
  std::vector<double> x, y;
  ConstShapeView View() const { return {x.data(), y.data()}; }
};

struct Case {
  PlanarMesh mesh;
  Cells cells;
  Shape shape;
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
    c.shape.x.push_back(q.real());
    c.shape.y.push_back(q.imag());
  }
  // A triangle and its neighbours that fall into one point: no direction.
  for (const std::uint32_t v : c.mesh.triangles[40]) {
    c.shape.x[v] = c.shape.x[0];
    c.shape.y[v] = c.shape.y[0];
  }
  return c;
}

bool SameBytes(const KernelColumn& a, const KernelColumn& b, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) {
    if (std::bit_cast<std::uint64_t>(a[k]) != std::bit_cast<std::uint64_t>(b[k])) return false;
  }
  return true;
}

TEST(LocalKernels, WideAndPlainGiveTheSameBytes) {
  if (!HasWide()) GTEST_SKIP() << "this processor has only the plain code";
  const LocalKernels &wide = Kernels(), &plain = PlainKernels();
  ASSERT_NE(wide.hinge_forces, plain.hinge_forces);
  KernelColumn x{}, y{}, p{}, q{};
  const Complex mean(0.6, -0.8);
  for (const Basis basis : {Basis::kEdge, Basis::kEdgeAsPublished}) {
    const Case c = MakeCase(basis, 5);
    const HingeTable& table = c.cells.hinges;
    for (std::size_t at = 0; at < table.size(); at += kKernelBlock) {
      const std::size_t count = std::min(kKernelBlock, table.size() - at);
      wide.hinge_forces(table, at, count, c.shape.View(), mean, mean, x, y);
      plain.hinge_forces(table, at, count, c.shape.View(), mean, mean, p, q);
      EXPECT_TRUE(SameBytes(x, p, count) && SameBytes(y, q, count)) << at;
      wide.hinge_energies(table, at, count, c.shape.View(), x);
      plain.hinge_energies(table, at, count, c.shape.View(), p);
      EXPECT_TRUE(SameBytes(x, p, count)) << at;
    }
  }
  const Case c = MakeCase(Basis::kFace, 6);
  const FaceTable& table = c.cells.faces;
  for (std::size_t at = 0; at < table.size(); at += kKernelBlock) {
    const std::size_t count = std::min(kKernelBlock, table.size() - at);
    wide.face_turns(table, at, count, c.shape.View(), mean, mean, x, y);
    plain.face_turns(table, at, count, c.shape.View(), mean, mean, p, q);
    EXPECT_TRUE(SameBytes(x, p, count) && SameBytes(y, q, count)) << at;
    wide.face_energies(table, at, count, c.shape.View(), x);
    plain.face_energies(table, at, count, c.shape.View(), p);
    EXPECT_TRUE(SameBytes(x, p, count)) << at;
  }
}

TEST(LocalKernels, ForceEnergyAndMatrixAgree) {
  for (const Basis basis : {Basis::kEdge, Basis::kEdgeAsPublished, Basis::kFace, Basis::kVertex}) {
    Case c = MakeCase(basis, 7);
    // In a turned rest shape every t̂ is that turn: the energy is 0, and Σ w t̂ e is what the matrix
    // of the same energy makes of the shape.
    const Complex turn = std::polar(1.0, 0.7);
    for (std::size_t v = 0; v < c.mesh.vertices.size(); ++v) {
      const Complex q = turn * c.mesh.vertices[v];
      c.shape.x[v] = q.real();
      c.shape.y[v] = q.imag();
    }
    EXPECT_LT(RigidEnergy(c.cells, c.shape.View()), 1e-20 * static_cast<double>(c.shape.x.size()));
    const std::vector<Complex> none(1, 0);
    std::vector<double> fx(c.shape.x.size()), fy(fx);
    AddRotatedEdges(c.cells, c.shape.View(), none, {fx.data(), fy.data()});
    const auto laplacian = AssembleRigid(c.cells, std::vector<bool>(fx.size(), false));
    const Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(
        c.shape.x.data(), static_cast<Eigen::Index>(c.shape.x.size()));
    const Eigen::VectorXd expected = laplacian.selfadjointView<Eigen::Lower>() * x;
    for (std::size_t v = 0; v < fx.size(); ++v) {
      EXPECT_NEAR(fx[v], expected[static_cast<Eigen::Index>(v)], 1e-10);
    }
  }
}

}  // namespace
}  // namespace arap
