// Frames that several threads share: the same bytes, whoever helps.
#include <cstring>
#include <string>
#include <vector>

#include "core/deform/registered_parts.h"
#include "tests/core/deform/fixture.h"
#include "tests/support/meshes.h"
#include "tests/support/thread_crew.h"

namespace arap::testing {
namespace {

struct Shape {
  std::vector<Complex> positions;
  ShapeQuality quality;
};

Shape ShapeOf(Deformer& deformer, const std::vector<Target>& targets, const DeformOptions& options,
              Crew* crew) {
  const ShapeQuality quality = Must(deformer.Update(targets, options, {}, crew));
  return {{deformer.positions().begin(), deformer.positions().end()}, quality};
}

void ExpectSameBytes(const Shape& a, const Shape& b) {
  ASSERT_EQ(a.positions.size(), b.positions.size());
  EXPECT_EQ(
      std::memcmp(a.positions.data(), b.positions.data(), a.positions.size() * sizeof(Complex)), 0);
  EXPECT_EQ(a.quality, b.quality);
}

constexpr std::size_t kThreads[] = {1, 2, 3, 7};

void ExpectSameBytesWithEveryCrew(const std::shared_ptr<const CompiledHandles>& set,
                                  const DeformOptions& options) {
  const auto targets = RandomTargets(*set, 3, 1), others = RandomTargets(*set, 9, 2);
  Deformer alone(set);
  const Shape expected = ShapeOf(alone, targets, options, nullptr);
  for (const std::size_t threads : kThreads) {
    SCOPED_TRACE(std::to_string(threads) + " threads");
    ThreadCrew crew(threads);
    Deformer deformer(set);
    ShapeOf(deformer, others, options, &crew);
    EXPECT_GT(crew.parts(), 10u);
    ExpectSameBytes(ShapeOf(deformer, targets, options, &crew), expected);
    ExpectSameBytes(ShapeOf(deformer, targets, options, nullptr), expected);
  }
}

TEST(CrewTest, GivesTheSameBytesOfSeveralComponents) {
  const PlanarMesh mesh = TwoComponents(110, 110, 3);
  for (const Basis basis : {Basis::kEdge, Basis::kFace, Basis::kVertex}) {
    SCOPED_TRACE(static_cast<int>(basis));
    const auto registered = Register(mesh, basis);
    ExpectSameBytesWithEveryCrew(Compile(registered, RandomHandles(mesh, 6, 5)), {});
  }
  // One component stays where it is.
  const std::vector<Handle> few{OnVertex("a", 3), OnVertex("b", 700)};
  ExpectSameBytesWithEveryCrew(Compile(Register(mesh), few), {DeformMode::kRigid, 2});
}

TEST(CrewTest, GivesTheSameBytesOfEveryKindOfHandleAndSolver) {
  const PlanarMesh mesh = JitteredGrid(150, 150, 4);
  auto handles = RandomHandles(mesh, 8, 6);
  handles[2].hard = true;
  const auto registered = Register(mesh);
  for (const HandleSolver solver : {HandleSolver::kNullSpace, HandleSolver::kDirect}) {
    SCOPED_TRACE(static_cast<int>(solver));
    ExpectSameBytesWithEveryCrew(Must(CompiledHandles::Compile(registered, handles, {}, solver)),
                                 {DeformMode::kRigid, 1});
  }
}

TEST(CrewTest, GivesTheSameBytesWhereTheFactorIsCut) {
  const PlanarMesh mesh = JitteredGrid(330, 330, 4);
  const auto registered = Register(mesh, Basis::kFace);
  // More than four million numbers.
  ASSERT_GT(registered->parts().rigid->bytes(), std::size_t{40} << 20u);
  const auto set = Compile(registered, RandomHandles(mesh, 4, 6));
  const auto targets = RandomTargets(*set, 3, 1);
  ThreadCrew crew(3);
  Deformer alone(set), helped(set);
  ExpectSameBytes(ShapeOf(helped, targets, {}, &crew), ShapeOf(alone, targets, {}, nullptr));
}

TEST(CrewTest, GivesFramesSideBySideTheBytesThatEachHasAlone) {
  const PlanarMesh mesh = JitteredGrid(150, 150, 4);
  const auto set = Compile(Register(mesh), RandomHandles(mesh, 5, 6));
  const auto one = RandomTargets(*set, 3, 1), two = RandomTargets(*set, 9, 2);
  ThreadCrew crew(3);
  Deformer together(set, 2), alone(set, 2);
  const std::span<const Target> both[] = {one, two};
  ShapeQuality qualities[2];
  ASSERT_TRUE(together.UpdateMany(both, {}, qualities, {}, 0, &crew).has_value());
  for (std::size_t i = 0; i < 2; ++i) {
    const auto positions = together.positions(i);
    ExpectSameBytes({{positions.begin(), positions.end()}, qualities[i]},
                    ShapeOf(alone, i == 0 ? one : two, {}, nullptr));
  }
}

TEST(CrewTest, GivesFramesOfTwoDeformersTheBytesThatEachHasAlone) {
  const PlanarMesh mesh = JitteredGrid(150, 150, 4);
  const auto registered = Register(mesh);
  const auto set = Compile(registered, RandomHandles(mesh, 5, 6)),
             other_set = Compile(registered, RandomHandles(mesh, 3, 9));
  const auto targets = RandomTargets(*set, 3, 1), others = RandomTargets(*other_set, 9, 2);
  ThreadCrew crew(3);
  Deformer one(set), other(other_set), alone(set), other_alone(other_set);
  JointFrame first{one, targets, {DeformMode::kRigid, 2}, {}, {}};
  JointFrame second{other, others, {}, {}, {}};
  UpdateTogether(first, second, &crew);
  EXPECT_GT(crew.parts(), 10u);
  ExpectSameBytes({{one.positions().begin(), one.positions().end()}, Must(first.quality)},
                  ShapeOf(alone, targets, {DeformMode::kRigid, 2}, nullptr));
  ExpectSameBytes({{other.positions().begin(), other.positions().end()}, Must(second.quality)},
                  ShapeOf(other_alone, others, {}, nullptr));
}

TEST(CrewTest, AFaultLeavesTheShapeAsItWas) {
  const PlanarMesh mesh = JitteredGrid(150, 150, 4);
  const auto set = Compile(Register(mesh), RandomHandles(mesh, 5, 6));
  const auto targets = RandomTargets(*set, 3, 1);
  auto far = targets;
  far[1].position = 1e308;
  far[2].position = -1e308;
  ThreadCrew crew(3);
  Deformer deformer(set);
  const Shape expected = ShapeOf(deformer, targets, {}, &crew);
  const auto failed = deformer.Update(far, {}, {}, &crew);
  ASSERT_FALSE(failed.has_value());
  EXPECT_EQ(failed.error().kind, FaultKind::kNumerical) << failed.error().message;
  int asked = 0;
  const CancelToken cancel([&asked]() -> Status {
    if (++asked < 2) return {};
    return Fail(FaultKind::kCancelled, "Enough.");
  });
  const auto others = RandomTargets(*set, 3, 2);
  const auto cancelled = deformer.Update(others, {DeformMode::kRigid, 3}, cancel, &crew);
  ASSERT_FALSE(cancelled.has_value());
  EXPECT_EQ(cancelled.error().kind, FaultKind::kCancelled);
  const auto positions = deformer.positions();
  ExpectSameBytes({{positions.begin(), positions.end()}, expected.quality}, expected);
  ExpectSameBytes(ShapeOf(deformer, targets, {}, &crew), expected);
}

}  // namespace
}  // namespace arap::testing
