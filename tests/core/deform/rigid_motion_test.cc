// Rigid motions of the handles move every vertex rigidly, whatever the mesh, its size or its place.
#include "tests/core/deform/fixture.h"
#include "tests/support/compare.h"
#include "tests/support/meshes.h"
#include "tests/support/print.h"

namespace arap::testing {
namespace {

struct RigidCase {
  const char* name;
  std::size_t side;
  Complex offset;
  double tolerance;
};

void PrintTo(const RigidCase& c, std::ostream* out) { *out << c.name; }

class RigidMotionTest : public ::testing::TestWithParam<RigidCase> {};

TEST_P(RigidMotionTest, MovesEveryVertexRigidly) {
  const RigidCase& c = GetParam();
  const PlanarMesh mesh = Moved(JitteredGrid(c.side, c.side, 7), 1, c.offset);
  for (const Basis basis : {Basis::kEdge, Basis::kEdgeAsPublished, Basis::kFace, Basis::kVertex}) {
    if (basis != Basis::kEdge && c.side > 100) continue;  // the default basis at full size
    const auto registered = Register(mesh, basis);
    for (const bool hard : {false, true}) {
      auto handles = RandomHandles(mesh, 6, 11);
      for (Handle& h : handles) h.hard = hard;
      const auto set = Compile(registered, handles);
      Deformer deformer(set);
      // The last one is ten diagonals away.
      const double diagonal = Diagonal(mesh.vertices);
      for (const RigidMotion& motion :
           {RigidMotion{0, {0, 100}}, RigidMotion{0.7, {3, 4}}, RigidMotion{3.1, {0, 0}},
            RigidMotion{-2.0, Complex(8, 6) * diagonal}}) {
        // About the mesh itself, so that a far place does not turn into a far motion.
        const auto move = [&](Complex p) { return motion(p - c.offset) + c.offset; };
        auto targets = set->RestTargets();
        for (Target& t : targets) t.position = move(t.position);
        const ShapeQuality quality = Must(deformer.Update(targets));
        std::vector<Complex> expected;
        for (const Complex p : mesh.vertices) expected.push_back(move(p));
        EXPECT_LE(MaxDistance(deformer.positions(), expected), c.tolerance * diagonal)
            << NameOf(basis) << " hard " << hard << " angle " << motion.angle;
        EXPECT_EQ(quality.flipped, 0u);
        EXPECT_NEAR(quality.max_stretch, 1, 1e-6);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, RigidMotionTest,
                         ::testing::Values(RigidCase{"v200", 13, 0, 1e-12},
                                           RigidCase{"v1600", 39, 0, 1e-12},
                                           RigidCase{"v10k", 99, 0, 1e-12},
                                           RigidCase{"v50k", 223, 0, 1e-12},
                                           RigidCase{"v200_far", 13, {1e6, -1e6}, 1e-9},
                                           RigidCase{"v10k_far", 99, {1e6, 1e6}, 1e-9},
                                           RigidCase{"v50k_far", 223, {-1e6, 1e6}, 1e-9}),
                         ::testing::PrintToStringParamName());

}  // namespace
}  // namespace arap::testing
