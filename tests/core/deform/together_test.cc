// Frames of two Deformers that share passes over a factor.
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/core/deform/fixture.h"
#include "tests/support/meshes.h"

namespace arap::testing {
namespace {

bool SameShape(const Deformer& a, const Deformer& b) {
  return std::equal(a.positions().begin(), a.positions().end(), b.positions().begin(),
                    b.positions().end());
}

TEST(UpdateTogetherTest, GivesEachTheBytesThatItHasAlone) {
  const PlanarMesh mesh = JitteredGrid(20, 20, 3);
  const auto registered = Register(mesh);
  // Two that read the mesh's factor, and one that was factored together with it.
  const auto few = Compile(registered, RandomHandles(mesh, 6, 2));
  auto held = RandomHandles(mesh, 9, 4);
  held[0].hard = true;
  const auto others = Compile(registered, held);
  const auto direct = Compile(registered, RandomHandles(mesh, 120, 5));
  const std::vector<DeformOptions> options{
      {}, {DeformMode::kRigid, 3}, {DeformMode::kBaseline, 0}, {DeformMode::kSimilarity, 0}};
  for (const auto& one_set : {few, others, direct}) {
    for (const auto& other_set : {few, direct}) {
      Deformer one(one_set), other(other_set), alone(one_set), other_alone(other_set);
      for (const DeformOptions& one_options : options) {
        for (const DeformOptions& other_options : options) {
          const auto one_targets = RandomTargets(*one_set, 4, 1);
          const auto other_targets = RandomTargets(*other_set, 7, 2);
          JointFrame frame{one, one_targets, one_options, {}, {}};
          JointFrame beside{other, other_targets, other_options, {}, {}};
          UpdateTogether(frame, beside);
          EXPECT_EQ(Must(frame.quality), Must(alone.Update(one_targets, one_options)));
          EXPECT_EQ(Must(beside.quality), Must(other_alone.Update(other_targets, other_options)));
          EXPECT_TRUE(SameShape(one, alone));
          EXPECT_TRUE(SameShape(other, other_alone));
        }
      }
    }
  }
}

TEST(UpdateTogetherTest, TheFaultOfOneIsNoneOfTheOthers) {
  const PlanarMesh mesh = JitteredGrid(8, 8, 3);
  const auto registered = Register(mesh);
  const auto set = Compile(registered, RandomHandles(mesh, 4, 2));
  const auto good_set = Compile(registered, RandomHandles(mesh, 5, 3));
  const auto good = RandomTargets(*good_set, 2, 1);
  const auto targets = RandomTargets(*set, 2, 1);
  auto bad = targets, far = targets;
  bad[2].position = std::nan("");
  far[1].position = 1e308;
  int asked = 0;
  const CancelToken cancel([&asked]() -> Status {
    if (++asked < 3) return {};
    return Fail(FaultKind::kCancelled, "The test cancelled it.");
  });
  struct Case {
    std::vector<Target> targets;
    DeformOptions options;
    CancelToken cancel;
    FaultKind fault;
  };
  for (const Case& c :
       {Case{bad, {}, {}, FaultKind::kNonFiniteTarget}, Case{far, {}, {}, FaultKind::kNumerical},
        Case{targets, {DeformMode::kRigid, -1}, {}, FaultKind::kInvalidOption},
        Case{targets, {DeformMode::kRigid, 9}, cancel, FaultKind::kCancelled}}) {
    for (const bool first : {true, false}) {
      asked = 0;
      Deformer faulty(set), sound(good_set), alone(good_set);
      JointFrame bad_frame{faulty, c.targets, c.options, c.cancel, {}};
      JointFrame good_frame{sound, good, {DeformMode::kRigid, 5}, {}, {}};
      first ? UpdateTogether(bad_frame, good_frame) : UpdateTogether(good_frame, bad_frame);
      ASSERT_FALSE(bad_frame.quality.has_value());
      EXPECT_EQ(bad_frame.quality.error().kind, c.fault);
      EXPECT_TRUE(
          std::equal(mesh.vertices.begin(), mesh.vertices.end(), faulty.positions().begin()));
      EXPECT_EQ(Must(good_frame.quality), Must(alone.Update(good, {DeformMode::kRigid, 5})));
      EXPECT_TRUE(SameShape(sound, alone));
    }
  }
}

TEST(SharedFactorTest, IsThatOfALargeMesh) {
  const PlanarMesh mesh = JitteredGrid(200, 200, 3), small = JitteredGrid(30, 30, 3);
  const auto registered = Register(mesh, Basis::kFace);
  const auto set = Compile(registered, RandomHandles(mesh, 3, 2));
  EXPECT_NE(SharedFactor(*set), nullptr);
  EXPECT_EQ(SharedFactor(*set), SharedFactor(*Compile(registered, RandomHandles(mesh, 5, 3))));
  EXPECT_NE(SharedFactor(*set), SharedFactor(*Compile(registered, RandomHandles(mesh, 120, 3))))
      << "factored together with its mesh";
  EXPECT_EQ(SharedFactor(*Compile(Register(small), RandomHandles(small, 3, 2))), nullptr);
}

}  // namespace
}  // namespace arap::testing
