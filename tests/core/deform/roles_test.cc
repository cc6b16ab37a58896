// Which hard rows depend on others, against dense linear algebra.
#include "core/deform/roles.h"

#include <random>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "tests/core/deform/fixture.h"
#include "tests/support/meshes.h"

namespace arap::testing {
namespace {

Row Holding(std::uint32_t v) {
  Row row;
  row.vertex = {v, v, v};
  row.weight = {1, 0, 0};
  return row;
}

// A row as the dense vector that it stands for.
Eigen::VectorXd Dense(const Row& row, Eigen::Index vertices) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(vertices);
  for (std::size_t k = 0; k < 3; ++k) x[row.vertex[k]] += row.weight[k];
  return x;
}

// Rows on a few vertices of a grid, so that many depend on one another: points in triangles and on
// edges, held vertices, some of them twice, some soft.
std::vector<Row> RandomRows(const PlanarMesh& mesh, std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Row> rows;
  for (std::size_t i = 0; i < count; ++i) {
    const Triangle& t = mesh.triangles[random() % mesh.triangles.size()];
    Row row;
    switch (random() % 4) {
      case 0:
        row = Holding(t[random() % 3]);
        break;
      case 1:
        row.vertex = t;
        row.weight = {0.25, 0, 0.75};
        break;
      default: {
        const double a = 0.1 * static_cast<double>(1 + random() % 4);
        row.vertex = t;
        row.weight = {a, 0.5, 0.5 - a};
        break;
      }
    }
    row.compliance = random() % 8 == 0 ? 1e-6 : 0;
    rows.push_back(row);
  }
  return rows;
}

TEST(RolesTest, FindsWhatDenseAlgebraFinds) {
  const PlanarMesh mesh = JitteredGrid(4, 4, 2);
  const auto n = static_cast<Eigen::Index>(mesh.vertices.size());
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const std::vector<Row> rows = RandomRows(mesh, 3 + seed, seed);
    const auto dependent = Must(FindDependentRows(rows, {}));
    std::vector<bool> depends(rows.size(), false);
    for (const DependentRow& d : dependent) {
      EXPECT_EQ(rows[d.row].compliance, 0);
      depends[d.row] = true;
    }
    // Each is exactly its combination of rows that are independent.
    for (const DependentRow& d : dependent) {
      Eigen::VectorXd left = Dense(rows[d.row], n);
      for (const auto& [row, coefficient] : d.combination) {
        EXPECT_FALSE(depends[row]);
        EXPECT_EQ(rows[row].compliance, 0);
        left -= coefficient * Dense(rows[row], n);
      }
      EXPECT_LE(left.norm(), 1e-7) << "seed " << seed << " row " << d.row;
    }
    Eigen::MatrixXd kept(n, 0);
    for (std::size_t r = 0; r < rows.size(); ++r) {
      if (depends[r] || rows[r].compliance != 0) continue;
      kept.conservativeResize(n, kept.cols() + 1);
      kept.rightCols(1) = Dense(rows[r], n);
    }
    if (kept.cols() == 0) continue;
    const Eigen::VectorXd singular = kept.jacobiSvd().singularValues();
    EXPECT_LE(kept.cols(), n);
    EXPECT_GE(singular[singular.size() - 1], 1e-6) << "seed " << seed;
  }
}

TEST(RolesTest, HeldVerticesComeBeforePointsAndTheEarlierRowDecides) {
  Row inside;
  inside.vertex = {0, 1, 2};
  inside.weight = {0.2, 0.3, 0.5};
  const std::vector<Row> rows{inside, Holding(1), Holding(0), Holding(2), Holding(1)};
  const auto dependent = Must(FindDependentRows(rows, {}));
  ASSERT_EQ(dependent.size(), 2u);
  EXPECT_EQ(dependent[0].row, 0u);
  const std::vector<std::pair<std::size_t, double>> corners{{1, 0.3}, {2, 0.2}, {3, 0.5}};
  EXPECT_EQ(dependent[0].combination, corners);
  EXPECT_EQ(dependent[1].row, 4u);
  const std::vector<std::pair<std::size_t, double>> first{{1, 1.0}};
  EXPECT_EQ(dependent[1].combination, first);
}

// Grows with the rows: with their square it would not end.
TEST(RolesTest, ManyHeldVerticesAreNoMatterOfAlgebra) {
  std::vector<Row> rows;
  for (std::uint32_t v = 0; v < 300'000; ++v) rows.push_back(Holding(v % 200'000));
  EXPECT_EQ(Must(FindDependentRows(rows, {})).size(), 100'000u);
}

TEST(RolesTest, CancelsBetweenRows) {
  const PlanarMesh mesh = JitteredGrid(9, 9, 2);
  const auto rows = RandomRows(mesh, 60, 3);
  int asked = 0;
  const CancelToken cancel([&]() -> Status {
    if (++asked < 5) return {};
    return Fail(FaultKind::kCancelled, "The test cancelled it.");
  });
  const auto dependent = FindDependentRows(rows, cancel);
  ASSERT_FALSE(dependent.has_value());
  EXPECT_EQ(dependent.error().kind, FaultKind::kCancelled);
}

}  // namespace
}  // namespace arap::testing
