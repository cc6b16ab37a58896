// Stars: pieces welded at single vertices, and vertices with very many edges.
#include "core/energy/cells.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/energy/assemble.h"
#include "tests/support/meshes.h"
#include "tests/support/must.h"

namespace arap::testing {
namespace {

// `count` triangles round vertex 0, each apart from the next or all in one fan.
PlanarMesh Round(std::uint32_t count, bool apart) {
  PlanarMesh mesh;
  mesh.vertices.push_back(0);
  const std::uint32_t rim = apart ? 2 * count : count;
  for (std::uint32_t k = 0; k < rim; ++k) {
    mesh.vertices.push_back(std::polar(1.0, 2 * std::numbers::pi * k / rim));
  }
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::uint32_t first = apart ? 2 * k : k;
    mesh.triangles.push_back({0, 1 + first, 1 + (first + 1) % rim});
  }
  return mesh;
}

// Triangles in a chain, each sharing one vertex with the next.
PlanarMesh Chain(std::uint32_t count) {
  PlanarMesh mesh;
  mesh.vertices.push_back(0);
  for (std::uint32_t k = 0; k < count; ++k) {
    mesh.vertices.push_back({k + 0.5, 1});
    mesh.vertices.push_back({k + 1.0, 0});
    mesh.triangles.push_back({2 * k, 2 * k + 2, 2 * k + 1});
  }
  return mesh;
}

struct Built {
  Topology topology;
  Result<CellSystem> system;
  std::size_t frames = 0;  // how often a triangle's shape was asked for
};

Built Build(const PlanarMesh& mesh, Basis basis) {
  Built built{BuildTopology(mesh.vertices.size(), mesh.triangles), CellSystem{}, 0};
  const auto frame = [&](std::uint32_t t) -> std::array<Complex, 3> {
    ++built.frames;
    const Triangle& k = mesh.triangles[t];
    return {mesh.vertices[k[0]], mesh.vertices[k[1]], mesh.vertices[k[2]]};
  };
  built.system =
      BuildCells(mesh.triangles, built.topology, {basis, Weights::kUniform, {}}, frame, true);
  return built;
}

TEST(CellsTest, WeldingLooksAtEveryEdgeOnce) {
  for (const std::uint32_t count : {50u, 3000u}) {
    const Built built = Build(Chain(count), Basis::kFace);
    EXPECT_EQ(Must(built.system).cells.stars.size(), count - 1);
    EXPECT_LE(built.frames, 8 * count);
  }
}

TEST(CellsTest, FewPiecesShareOneStarAndManyAreWeldedByTurns) {
  const Built few = Build(Round(20, true), Basis::kEdge);
  const StarTable& one = few.system->cells.stars;
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one.spokes.size(), 40u);

  const Built many = Build(Round(2000, true), Basis::kEdge);
  const StarTable& stars = many.system->cells.stars;
  ASSERT_EQ(stars.size(), 1999u);
  std::vector<bool> welded(2000, false);
  for (std::size_t s = 0; s < stars.size(); ++s) {
    EXPECT_LE(stars.begin[s + 1] - stars.begin[s], 16u);
    for (std::size_t k = stars.begin[s]; k < stars.begin[s + 1]; ++k) {
      EXPECT_EQ(stars.spokes[k].a, 0u);
      welded[(stars.spokes[k].b - 1) / 2] = true;
    }
  }
  EXPECT_EQ(std::count(welded.begin(), welded.end(), true), 2000);
}

TEST(CellsTest, TheMatrixOfALargeStarIsTheSumOfItsResiduals) {
  const PlanarMesh mesh = Round(150, false);
  const Built built = Build(mesh, Basis::kVertex);
  const Cells& cells = built.system->cells;
  const std::size_t n = mesh.vertices.size();
  const Eigen::SparseMatrix<Complex> lower = AssembleSimilarity(cells, std::vector<bool>(n, false));
  for (const std::uint32_t v : {0u, 1u, 77u, 150u}) {
    std::vector<Complex> unit(n);
    unit[v] = 1;
    const std::vector<Complex> expected = SimilarityForceAt(cells, unit).force;  // a column
    for (std::uint32_t row = v; row < n; ++row) {
      const Complex got = lower.coeff(static_cast<int>(row), static_cast<int>(v));
      EXPECT_LE(std::abs(got - expected[row]), 1e-11) << row << " " << v;
      if (row == v) {
        EXPECT_EQ(got.imag(), 0);
      }
    }
  }
}

TEST(CellsTest, TheMatrixOfFacesIsTheSumOfTheirResiduals) {
  const PlanarMesh mesh = JitteredGrid(6, 5, 3);
  for (const Weights weights : {Weights::kUniform, Weights::kCotangent}) {
    const Topology topology = BuildTopology(mesh.vertices.size(), mesh.triangles);
    const auto frame = [&](std::uint32_t t) -> std::array<Complex, 3> {
      const Triangle& k = mesh.triangles[t];
      return {mesh.vertices[k[0]], mesh.vertices[k[1]], mesh.vertices[k[2]]};
    };
    const EnergyOptions options{Basis::kFace, weights, {}};
    const Cells cells = Must(BuildCells(mesh.triangles, topology, options, frame, true)).cells;
    const std::size_t n = mesh.vertices.size();
    const auto lower = AssembleSimilarity(cells, std::vector<bool>(n, false));
    for (std::uint32_t v = 0; v < n; ++v) {
      std::vector<Complex> unit(n);
      unit[v] = 1;
      const std::vector<Complex> expected = SimilarityForceAt(cells, unit).force;  // a column
      for (std::uint32_t row = v; row < n; ++row) {
        const Complex got = lower.coeff(static_cast<int>(row), static_cast<int>(v));
        EXPECT_LE(std::abs(got - expected[row]), 1e-13) << row << " " << v;
      }
    }
  }
}

TEST(CellsTest, VertexCellsRefuseAVertexWhoseMatrixWouldBeHuge) {
  EXPECT_TRUE(Build(Round(1900, false), Basis::kVertex).system.has_value());
  const Built built = Build(Round(4000, false), Basis::kVertex);
  ASSERT_FALSE(built.system.has_value());
  EXPECT_EQ(built.system.error().kind, FaultKind::kInvalidOption);
  EXPECT_EQ(built.system.error().field, "energy.basis");
  EXPECT_EQ(built.system.error().elements, std::vector<std::uint32_t>{0});
  EXPECT_TRUE(Build(Round(4000, false), Basis::kFace).system.has_value());
}

}  // namespace
}  // namespace arap::testing
