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

TEST(CostTest, AreasThatOverlapTooMuchAreRefusedBeforeTheirRowsAreMade) {
  const PlanarMesh mesh = JitteredGrid(60, 60, 3);
  const auto registered = Register(mesh);
  std::vector<Handle> handles;
  for (std::uint32_t i = 0; i < 60; ++i) {
    handles.push_back(OnVertex("h" + std::to_string(i), i));
    handles.back().area_radius = 1000;
  }
  const std::size_t last = MostRows(mesh.vertices.size()) / mesh.vertices.size();
  ASSERT_LT(last, handles.size());
  const auto counted = CountRows(*registered, handles);
  const auto compiled = CompiledHandles::Compile(registered, handles);
  ASSERT_FALSE(counted.has_value() || compiled.has_value());
  for (const Fault& fault : {counted.error(), compiled.error()}) {
    EXPECT_EQ(fault.kind, FaultKind::kTooManyHandles);
    EXPECT_EQ(fault.field, "handles[" + std::to_string(last) + "].area_radius");
    EXPECT_EQ(DetailOf(fault, "limit"), std::to_string(MostRows(mesh.vertices.size())));
  }
  handles.resize(last);
  EXPECT_EQ(Must(CountRows(*registered, handles)).rows, last * mesh.vertices.size());
}

TEST(CostTest, SaysWhetherAnEditFactors) {
  const PlanarMesh mesh = JitteredGrid(20, 15, 4);
  const auto registered = Register(mesh);
  const auto handles = RandomHandles(mesh, kDirectRows + 4, 5);
  const auto few = Compile(registered, {handles.begin(), handles.begin() + kDirectRows});
  const auto many = Compile(registered, handles);
  const RowCount one{1, 0, 0, 0}, none{};
  const std::vector<std::string> five{"h0", "h1", "h2", "h3", "h4"}, unknown{"nobody"};

  EXPECT_FALSE(EstimateEdit(*few, five, one).factors);
  EXPECT_TRUE(EstimateEdit(*few, {}, one).factors);
  EXPECT_TRUE(EstimateEdit(*few, unknown, one).factors);
  EXPECT_TRUE(EstimateEdit(*many, {}, none).factors);
  EXPECT_FALSE(EstimateEdit(*many, five, one).factors);
  EXPECT_EQ(Must(few->Edit({}, {handles.back()}))->direct(), true);
  EXPECT_EQ(Must(many->Edit(five, {}))->direct(), false);

  // A row more is cheap beside all rows anew.
  const auto eight = Compile(registered, {handles.begin(), handles.begin() + 8});
  EXPECT_LT(EstimateEdit(*eight, {}, one).cost.milliseconds,
            EstimateEdit(*many, five, one).cost.milliseconds / 4);
}

TEST(CostTest, CoversTheMemoryThatIsKept) {
  for (const std::size_t side : {10u, 40u, 120u}) {
    for (const Basis basis : {Basis::kEdge, Basis::kFace, Basis::kVertex}) {
      const PlanarMesh mesh = JitteredGrid(side, side, 2);
      const auto registered = Register(mesh, basis);
      EXPECT_GE(EstimateRegistration(mesh.vertices.size(), basis).bytes,
                registered->report().bytes);
      for (const std::size_t count : {4u, 60u, 120u}) {
        const auto set = Compile(registered, RandomHandles(mesh, count, 3));
        EXPECT_GE(EstimateCompilation(*registered, CountRows(*set)).bytes, set->bytes());
      }
    }
  }
}

// An owner has 4 GiB unless told otherwise, and a mesh a million vertices at most.
TEST(CostTest, TheLargestMeshIsAccepted) {
  for (const Basis basis : {Basis::kEdge, Basis::kFace, Basis::kVertex}) {
    EXPECT_LT(EstimateRegistration(1'000'000, basis).bytes, std::size_t{4} << 30);
  }
}

TEST(CostTest, CountsTheHandlesAndTheirIds) {
  const PlanarMesh mesh = JitteredGrid(10, 10, 2);
  const auto registered = Register(mesh);
  auto handles = RandomHandles(mesh, 100, 3);
  const std::size_t plain = Compile(registered, handles)->bytes();
  EXPECT_GT(plain, handles.size() * sizeof(PlacedHandle));
  for (Handle& handle : handles) handle.id.insert(0, 100, 'n');
  const auto set = Compile(registered, handles);
  EXPECT_GE(set->bytes(), plain + 100 * handles.size());
  EXPECT_GE(EstimateCompilation(*registered, CountRows(*set)).bytes, set->bytes());
}

TEST(CostTest, GrowsWithEverythingThatIsAskedFor) {
  const PlanarMesh mesh = JitteredGrid(30, 30, 2);
  const auto registered = Register(mesh);
  for (const std::size_t count : {5u, 120u}) {
    auto handles = RandomHandles(mesh, count, 3);
    const auto set = Compile(registered, handles);
    const double plain = EstimateFrame(*set, {}).milliseconds;
    EXPECT_GT(EstimateFrame(*set, {DeformMode::kRigid, 1000}).milliseconds, 100 * plain);
    EXPECT_LT(EstimateFrame(*set, {DeformMode::kSimilarity, 1000}).milliseconds, plain);
    EXPECT_GT(EstimateFrame(*set, {}, 1000).milliseconds, plain);
    RowCount more = CountRows(*set);
    const double compile = EstimateCompilation(*registered, more).milliseconds;
    more.depths = 1000;
    EXPECT_GT(EstimateCompilation(*registered, more).milliseconds, compile);
    more.inside = more.rows += 1000;
    EXPECT_GT(EstimateCompilation(*registered, more).milliseconds, compile);
  }
  EXPECT_GT(EstimateRegistration(200'000, Basis::kEdge).milliseconds,
            2 * EstimateRegistration(100'000, Basis::kEdge).milliseconds);
}

}  // namespace
}  // namespace arap::testing
