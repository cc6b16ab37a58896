// The fast path against the paper in dense matrices: 50 random meshes and poses.
#include "tests/support/textbook.h"

#include "tests/core/deform/fixture.h"
#include "tests/support/compare.h"
#include "tests/support/meshes.h"
#include "tests/support/print.h"

namespace arap::testing {
namespace {

std::vector<TextbookHandle> AsTextbook(const PlanarMesh& mesh, const std::vector<Handle>& handles) {
  std::vector<TextbookHandle> rows;
  for (const Handle& h : handles) {
    const auto& anchor = std::get<TriangleAnchor>(h.anchor);
    rows.push_back({mesh.triangles[anchor.triangle], anchor.barycentric, h.weight});
  }
  return rows;
}

class TextbookTest : public ::testing::TestWithParam<int> {};

TEST_P(TextbookTest, AgreesOnBothVariantsAndWeights) {
  const auto seed = static_cast<std::uint64_t>(GetParam());
  const std::size_t nx = 3 + seed % 5, ny = 3 + seed % 4;
  const PlanarMesh mesh =
      Moved(JitteredGrid(nx, ny, seed), std::polar(1.0 + 10.0 * (GetParam() % 3), 0.3),
            {static_cast<double>(seed), -5});
  auto handles = RandomHandles(mesh, 2 + seed % 5, seed + 100);
  if (seed % 4 == 0) handles[0].weight = 30;
  for (const bool both : {true, false}) {
    for (const Weights weights : {Weights::kUniform, Weights::kCotangent}) {
      const auto set =
          Compile(Register(mesh, both ? Basis::kEdge : Basis::kEdgeAsPublished, weights), handles);
      const auto targets = RandomTargets(*set, 0.3 * Diagonal(mesh.vertices), seed);
      std::vector<Complex> points;
      for (const Target& t : targets) points.push_back(t.position);
      std::vector<Complex> first;
      const auto expected =
          TextbookDeform(mesh, both, weights, AsTextbook(mesh, handles), points, &first);
      EXPECT_LE(RelativeDistance(Deform(set, targets), expected), 1e-7)
          << "both " << both << ", " << NameOf(weights);
      EXPECT_LE(RelativeDistance(Deform(set, targets, {DeformMode::kSimilarity, 0}), first), 1e-7)
          << "first step, both " << both << ", " << NameOf(weights);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, TextbookTest, ::testing::Range(0, 50));

}  // namespace
}  // namespace arap::testing
