// The transcription of the paper does what the paper promises, and each slip of the print breaks
// it.
#include "tests/support/textbook.h"

#include <gtest/gtest.h>

#include "tests/support/compare.h"
#include "tests/support/meshes.h"
#include "tests/support/poses.h"
#include "tests/support/print.h"

namespace arap::testing {
namespace {

struct Variant {
  bool both_directions;
  Weights weights;
};

void PrintTo(const Variant& variant, std::ostream* out) {
  *out << (variant.both_directions ? "both_ways_" : "one_way_") << NameOf(variant.weights);
}

class TextbookDeformTest : public ::testing::TestWithParam<Variant> {
 protected:
  std::vector<Complex> Deform(const PlanarMesh& mesh, std::span<const TextbookHandle> handles,
                              std::span<const Complex> targets,
                              std::vector<Complex>* first_step = nullptr) const {
    return TextbookDeform(mesh, GetParam().both_directions, GetParam().weights, handles, targets,
                          first_step);
  }
};

INSTANTIATE_TEST_SUITE_P(Variants, TextbookDeformTest,
                         ::testing::Values(Variant{false, Weights::kUniform},
                                           Variant{true, Weights::kUniform},
                                           Variant{false, Weights::kCotangent},
                                           Variant{true, Weights::kCotangent}),
                         ::testing::PrintToStringParamName());

TEST_P(TextbookDeformTest, RestPoseIsAFixedPoint) {
  const PlanarMesh mesh = JitteredGrid(5, 4, 1);
  const auto handles = RandomInnerHandles(mesh, 3, 2);
  std::vector<Complex> first;
  const auto shape = Deform(mesh, handles, RestTargets(mesh, handles), &first);
  EXPECT_LT(RelativeDistance(shape, mesh.vertices), 1e-12);
  EXPECT_LT(RelativeDistance(first, mesh.vertices), 1e-12);
}

TEST_P(TextbookDeformTest, RigidMotionOfTheHandlesMovesTheWholeShape) {
  const PlanarMesh mesh = JitteredGrid(5, 4, 3);
  const auto handles = RandomVertexHandles(mesh, 3, 4);
  const RigidMotion motion{2.2, Complex(40, -25)};
  const auto shape = Deform(mesh, handles, Apply(motion, RestTargets(mesh, handles)));
  EXPECT_LT(RelativeDistance(shape, Apply(motion, mesh.vertices)), 1e-12);
}

TEST_P(TextbookDeformTest, FirstStepFollowsAScaleAndTheSecondUndoesIt) {
  const PlanarMesh mesh = JitteredGrid(5, 4, 5);
  const auto handles = RandomVertexHandles(mesh, 2, 6, 1e-3);
  std::vector<Complex> targets = RestTargets(mesh, handles);
  for (Complex& target : targets) target *= 3.0;
  std::vector<Complex> first;
  const auto shape = Deform(mesh, handles, targets, &first);
  EXPECT_LT(RelativeDistance(first, Moved(mesh, 3, 0).vertices), 1e-9);
  EXPECT_NEAR(Diagonal(shape) / Diagonal(mesh.vertices), 1, 0.05);
}

TEST_P(TextbookDeformTest, ResultMovesWithTheMesh) {
  const PlanarMesh mesh = JitteredGrid(4, 4, 7);
  const auto handles = RandomVertexHandles(mesh, 4, 8);
  const auto targets = RandomPose(mesh, RestTargets(mesh, handles), 0.3, 9);
  const RigidMotion far{0, Complex(1e4, -3e4)};
  const auto here = Deform(mesh, handles, targets);
  const auto there = Deform(Moved(mesh, 1, far.shift), handles, Apply(far, targets));
  EXPECT_LT(RelativeDistance(there, Apply(far, here)), 1e-9);
}

TEST_P(TextbookDeformTest, HeavyHandlesAreMet) {
  const PlanarMesh mesh = JitteredGrid(4, 4, 7);
  const auto handles = RandomInnerHandles(mesh, 4, 8, 1e10);
  const auto targets = RandomPose(mesh, RestTargets(mesh, handles), 0.3, 9);
  PlanarMesh deformed = mesh;
  deformed.vertices = Deform(mesh, handles, targets);
  EXPECT_LT(MaxDistance(RestTargets(deformed, handles), targets), 1e-7);
}

TEST(TextbookDeform, BothDirectionsDoNotDependOnTheNumbering) {
  const PlanarMesh mesh = JitteredGrid(4, 4, 11);
  const auto handles = RandomVertexHandles(mesh, 4, 12);
  const auto targets = RandomPose(mesh, RestTargets(mesh, handles), 0.3, 13);
  const RenumberedMesh renumbered = Renumbered(mesh, 14);
  auto moved_handles = handles;
  for (TextbookHandle& handle : moved_handles) {
    for (std::uint32_t& v : handle.vertices) v = renumbered.new_vertex[v];
  }
  const auto distance = [&](bool both_directions) {
    const auto expected =
        TextbookDeform(mesh, both_directions, Weights::kUniform, handles, targets);
    const auto shape =
        TextbookDeform(renumbered.mesh, both_directions, Weights::kUniform, moved_handles, targets);
    std::vector<Complex> actual;
    for (const std::uint32_t v : renumbered.new_vertex) actual.push_back(shape[v]);
    return RelativeDistance(actual, expected);
  };
  EXPECT_LT(distance(true), 1e-11);
  EXPECT_GT(distance(false), 1e-4);
}

TEST(TextbookDeform, UnreferencedVerticesStayAtRest) {
  PlanarMesh mesh = JitteredGrid(3, 3, 15);
  mesh.vertices.insert(mesh.vertices.begin() + 5, Complex(100, 100));
  for (Triangle& t : mesh.triangles) {
    for (std::uint32_t& v : t) v += v >= 5 ? 1 : 0;
  }
  const auto handles = RandomVertexHandles(mesh, 2, 16);
  const RigidMotion motion{1, Complex(3, 4)};
  const auto shape = TextbookDeform(mesh, true, Weights::kUniform, handles,
                                    Apply(motion, RestTargets(mesh, handles)));
  auto expected = Apply(motion, mesh.vertices);
  expected[5] = mesh.vertices[5];
  EXPECT_LT(MaxDistance(shape, expected), 1e-10);
}

// Slips of the print [algorithm §7].

TEST(PrintedSlips, AbsolutePositionsInTheFitAreNotTranslationInvariant) {
  const PlanarMesh mesh = Grid(6, 6, 400, 400);
  const std::vector<TextbookHandle> handles{OnVertex(0), OnVertex(48)};
  auto targets = RestTargets(mesh, handles);
  const RigidMotion lift{0, Complex(0, 100)};
  targets = Apply(lift, targets);
  const auto expected = Apply(lift, mesh.vertices);
  const auto error = [&](Slip slip) {
    return MaxDistance(
        TextbookDeform(mesh, false, Weights::kUniform, handles, targets, nullptr, slip), expected);
  };
  EXPECT_LT(error(Slip::kNone), 1e-9);
  EXPECT_GT(error(Slip::kAbsoluteFit), 10);
}

TEST(PrintedSlips, SquaredNormaliserDoesNotRemoveTheScale) {
  const PlanarMesh mesh = JitteredGrid(6, 6, 17);
  // Light handles, so that the second step shows the size of the rotated edges and nothing else.
  const auto handles = RandomVertexHandles(mesh, 2, 18, 1e-6);
  auto targets = RestTargets(mesh, handles);
  for (Complex& target : targets) target *= 2.0;
  const auto size = [&](Slip slip) {
    return Diagonal(
               TextbookDeform(mesh, true, Weights::kUniform, handles, targets, nullptr, slip)) /
           Diagonal(mesh.vertices);
  };
  EXPECT_NEAR(size(Slip::kNone), 1, 1e-3);
  EXPECT_NEAR(size(Slip::kSquaredNormaliser), 0.5, 1e-3);
}

}  // namespace
}  // namespace arap::testing
