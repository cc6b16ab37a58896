// The two solvers, edits and fresh compilations all lead to the same minimiser.
#include "tests/core/deform/fixture.h"
#include "tests/support/compare.h"
#include "tests/support/meshes.h"
#include "tests/support/print.h"

namespace arap::testing {
namespace {

std::shared_ptr<const CompiledHandles> CompileWith(
    const std::shared_ptr<const RegisteredMesh>& mesh, const std::vector<Handle>& handles,
    HandleSolver solver) {
  return Must(CompiledHandles::Compile(mesh, handles, {}, solver));
}

struct SolverCase {
  Basis basis;
  Weights weights;
  int hard;  // every so manyth handle is hard; 0: none
};

void PrintTo(const SolverCase& c, std::ostream* out) {
  *out << NameOf(c.basis) << "_" << NameOf(c.weights) << "_hard_" << c.hard;
}

class SolversTest : public ::testing::TestWithParam<SolverCase> {};

TEST_P(SolversTest, DirectAndNullSpaceAgree) {
  const auto& [basis, weights, hard] = GetParam();
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const PlanarMesh mesh = TwoComponents(14, 12, seed);
    const auto registered = Register(mesh, basis, weights);
    auto handles = RandomHandles(mesh, 12, seed);
    for (std::size_t i = 0; hard != 0 && i < handles.size(); i += static_cast<std::size_t>(hard)) {
      handles[i].hard = true;
    }
    const auto a = CompileWith(registered, handles, HandleSolver::kNullSpace);
    const auto b = CompileWith(registered, handles, HandleSolver::kDirect);
    EXPECT_FALSE(a->direct());
    EXPECT_TRUE(b->direct());
    const auto targets = RandomTargets(*a, 5, seed);
    for (const DeformMode mode :
         {DeformMode::kRigid, DeformMode::kSimilarity, DeformMode::kBaseline}) {
      const DeformOptions options{mode, mode == DeformMode::kRigid ? 3 : 0};
      EXPECT_LE(RelativeDistance(Deform(b, targets, options), Deform(a, targets, options)), 1e-8)
          << "seed " << seed << " mode " << static_cast<int>(mode);
    }
  }
}

// Held areas, held triangles and hard points beside and inside them, soft ones among them.
TEST_P(SolversTest, HardAreasAgree) {
  const auto& [basis, weights, hard] = GetParam();
  for (const std::uint64_t seed : {1u, 2u}) {
    const PlanarMesh mesh = TwoComponents(14, 12, seed);
    const auto registered = Register(mesh, basis, weights);
    auto handles = RandomHandles(mesh, 10, seed);
    for (std::size_t i = 0; i < handles.size(); ++i) {
      handles[i].hard = i != 7;
      handles[i].oriented = i == 2 || i == 3;
      if (i < 2) handles[i].area_radius = 1.6;
    }
    const auto a = CompileWith(registered, handles, HandleSolver::kNullSpace);
    const auto b = CompileWith(registered, handles, HandleSolver::kDirect);
    EXPECT_EQ(a->rows(), b->rows());
    EXPECT_GT(a->rows(), 20u);
    // Targets of a rigid motion never contradict one another; those of free handles may move too.
    const RigidMotion motion{0.4, {3, -2}};
    auto targets = a->RestTargets();
    for (Target& t : targets) t.position = motion(t.position), t.angle = 0.4;
    targets[7].position += Complex(1, 2);
    for (const DeformMode mode :
         {DeformMode::kRigid, DeformMode::kSimilarity, DeformMode::kBaseline}) {
      const DeformOptions options{mode, mode == DeformMode::kRigid ? 3 : 0};
      const auto x = Deform(a, targets, options), y = Deform(b, targets, options);
      EXPECT_LE(RelativeDistance(y, x), 1e-8) << "seed " << seed << " " << static_cast<int>(mode);
      // Hard is hard.
      for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        if (std::abs(mesh.vertices[v] - a->handles()[0].rest) > 1.5) continue;
        if ((v < mesh.vertices.size() / 2) != (a->handles()[0].component == 0)) continue;
        EXPECT_LE(std::abs(y[v] - motion(mesh.vertices[v])), 1e-9);
      }
    }
  }
}

TEST_P(SolversTest, EditsEqualFreshCompilations) {
  const auto& [basis, weights, hard] = GetParam();
  const PlanarMesh mesh = JitteredGrid(20, 15, 4);
  const auto registered = Register(mesh, basis, weights);
  auto handles = RandomHandles(mesh, 9, 5);
  for (std::size_t i = 0; hard != 0 && i < handles.size(); i += static_cast<std::size_t>(hard)) {
    handles[i].hard = true;
  }
  const std::vector<Handle> first(handles.begin(), handles.begin() + 5);
  const std::vector<Handle> rest(handles.begin() + 5, handles.end());
  const auto few = Compile(registered, first);
  const auto all = Compile(registered, handles);
  const auto added = Must(few->Edit({}, rest));
  const auto targets = RandomTargets(*all, 4, 6);
  EXPECT_LE(RelativeDistance(Deform(added, targets), Deform(all, targets)), 1e-9);

  // Adding and removing again is the identity, to the last bit.
  const std::vector<std::string> ids{"h5", "h6", "h7", "h8"};
  const auto back = Must(added->Edit(ids, {}));
  const auto some = RandomTargets(*few, 4, 7);
  EXPECT_EQ(Deform(back, some), Deform(few, some));

  // Removing from the middle keeps the order of the others.
  const std::vector<std::string> middle{"h1", "h3"};
  const auto without = Must(all->Edit(middle, {}));
  std::vector<Handle> kept;
  for (const Handle& h : handles) {
    if (h.id != "h1" && h.id != "h3") kept.push_back(h);
  }
  const auto fresh = Compile(registered, kept);
  const auto others = RandomTargets(*fresh, 4, 8);
  EXPECT_LE(RelativeDistance(Deform(without, others), Deform(fresh, others)), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Kinds, SolversTest,
                         ::testing::Values(SolverCase{Basis::kEdge, Weights::kUniform, 0},
                                           SolverCase{Basis::kEdge, Weights::kUniform, 3},
                                           SolverCase{Basis::kEdgeAsPublished, Weights::kCotangent,
                                                      2},
                                           SolverCase{Basis::kFace, Weights::kCotangent, 1},
                                           SolverCase{Basis::kVertex, Weights::kUniform, 4}),
                         ::testing::PrintToStringParamName());

TEST(SolverChoiceTest, ManyRowsFactorDirectlyAndEditsCrossTheThreshold) {
  const PlanarMesh mesh = JitteredGrid(20, 15, 4);
  const auto registered = Register(mesh);
  const auto handles = RandomHandles(mesh, kDirectRows + 4, 5);
  const auto many = Compile(registered, handles);
  EXPECT_TRUE(many->direct());
  std::vector<std::string> remove;
  for (int i = 0; i < 10; ++i) remove.push_back("h" + std::to_string(i));
  const auto fewer = Must(many->Edit(remove, {}));
  EXPECT_FALSE(fewer->direct());
  const auto fresh = Compile(registered, {handles.begin() + 10, handles.end()});
  const auto targets = RandomTargets(*fresh, 2, 1);
  EXPECT_EQ(Deform(fewer, targets), Deform(fresh, targets));
  const auto again = Must(fewer->Edit({}, {handles.begin(), handles.begin() + 10}));
  EXPECT_TRUE(again->direct());
}

TEST(SolverChoiceTest, AWholeMeshHeldHardIsWhereItIsPut) {
  const PlanarMesh mesh = JitteredGrid(60, 60, 3);  // 3,721 rows, all hard
  Handle all = OnVertex("all", 0);
  all.hard = true;
  all.area_radius = 1000;
  const auto set = Compile(Register(mesh), {all});
  ASSERT_TRUE(set->direct());
  EXPECT_EQ(set->rows(), mesh.vertices.size());
  const RigidMotion motion{0.7, {30, -20}};
  const Target target{motion(mesh.vertices[0]), 0.7, 1};
  EXPECT_LE(RelativeDistance(Deform(set, {target}), Apply(motion, mesh.vertices)), 1e-12);
}

TEST(SolverChoiceTest, DirectIsExactForRigidMotionsToo) {
  const PlanarMesh mesh = JitteredGrid(60, 60, 3);
  const auto set = Compile(Register(mesh), RandomHandles(mesh, 200, 2));
  ASSERT_TRUE(set->direct());
  const RigidMotion motion{2.2, {300, -200}};
  auto targets = set->RestTargets();
  for (Target& t : targets) t.position = motion(t.position);
  EXPECT_LE(RelativeDistance(Deform(set, targets), Apply(motion, mesh.vertices)), 1e-12);
}

}  // namespace
}  // namespace arap::testing
