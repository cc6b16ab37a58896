// Costs told beforehand: what they say of the kind of work, and of the memory that is kept.
#include "arap/core/cost.h"

#include "tests/core/deform/fixture.h"
#include "tests/support/meshes.h"

namespace arap::testing {
namespace {

TEST(CostTest, CountsTheRowsThatCompilationMakes) {
  const PlanarMesh mesh = TwoComponents(14, 12, 3);
  const auto registered = Register(mesh);
  auto handles = RandomHandles(mesh, 8, 4);
  handles[0].area_radius = 3;
  handles[1].oriented = true;
  handles[2].hard = handles[3].hard = true;
  handles[4].depth = -1;
  const RowCount before = Must(CountRows(*registered, handles));
  const auto set = Compile(registered, handles);
  EXPECT_EQ(before, CountRows(*set));
  EXPECT_EQ(before.rows, set->rows());
  EXPECT_EQ(before.inside, 2u);
  EXPECT_EQ(before.depths, 1u);

  handles[5].anchor = PointAnchor{{1000, 0}};
  const auto outside = CountRows(*registered, handles);
  ASSERT_FALSE(outside.has_value());
  EXPECT_EQ(outside.error().kind, FaultKind::kHandleOutside);
}

TEST(CostTest, SaysWhetherAnEditFactors) {
  const PlanarMesh mesh = JitteredGrid(20, 15, 4);
  const auto registered = Register(mesh);
  const auto handles = RandomHandles(mesh, kDirectRows + 4, 5);
  const auto few = Compile(registered, {handles.begin(), handles.begin() + kDirectRows});
  const auto many = Compile(registered, handles);
  const RowCount one{1, 0, 0}, none{};
  const std::vector<std::string> five{"h0", "h1", "h2", "h3", "h4"}, unknown{"nobody"};

  EXPECT_FALSE(CostOfEdit(*few, five, one).factors);
  EXPECT_TRUE(CostOfEdit(*few, {}, one).factors);
  EXPECT_TRUE(CostOfEdit(*few, unknown, one).factors);
  EXPECT_TRUE(CostOfEdit(*many, {}, none).factors);
  EXPECT_FALSE(CostOfEdit(*many, five, one).factors);
  EXPECT_EQ(Must(few->Edit({}, {handles.back()}))->direct(), true);
  EXPECT_EQ(Must(many->Edit(five, {}))->direct(), false);

  // A row more is cheap beside all rows anew.
  const auto eight = Compile(registered, {handles.begin(), handles.begin() + 8});
  EXPECT_LT(CostOfEdit(*eight, {}, one).cost.seconds,
            CostOfEdit(*many, five, one).cost.seconds / 4);
}

TEST(CostTest, CoversTheMemoryThatIsKept) {
  for (const std::size_t side : {10u, 40u, 120u}) {
    for (const Basis basis : {Basis::kEdge, Basis::kFace, Basis::kVertex}) {
      const PlanarMesh mesh = JitteredGrid(side, side, 2);
      const auto registered = Register(mesh, basis);
      EXPECT_GE(RegistrationCost(mesh.vertices.size(), basis).bytes, registered->report().bytes);
      for (const std::size_t count : {4u, 60u, 120u}) {
        const auto set = Compile(registered, RandomHandles(mesh, count, 3));
        EXPECT_GE(CompilationCost(*registered, CountRows(*set)).bytes, set->bytes());
      }
    }
  }
}

TEST(CostTest, GrowsWithEverythingThatIsAskedFor) {
  const PlanarMesh mesh = JitteredGrid(30, 30, 2);
  const auto registered = Register(mesh);
  for (const std::size_t count : {5u, 120u}) {
    auto handles = RandomHandles(mesh, count, 3);
    const auto set = Compile(registered, handles);
    const double plain = FrameCost(*set, {}).seconds;
    EXPECT_GT(FrameCost(*set, {DeformMode::kRigid, 1000}).seconds, 100 * plain);
    EXPECT_LT(FrameCost(*set, {DeformMode::kSimilarity, 1000}).seconds, plain);
    EXPECT_GT(FrameCost(*set, {}, 1000).seconds, plain);
    RowCount more = CountRows(*set);
    const double compile = CompilationCost(*registered, more).seconds;
    more.depths = 1000;
    EXPECT_GT(CompilationCost(*registered, more).seconds, compile);
    more.inside = more.rows += 1000;
    EXPECT_GT(CompilationCost(*registered, more).seconds, compile);
  }
  EXPECT_GT(RegistrationCost(200'000, Basis::kEdge).seconds,
            2 * RegistrationCost(100'000, Basis::kEdge).seconds);
}

}  // namespace
}  // namespace arap::testing
