// Ids of a set are found without going through the set.
#include <algorithm>
#include <bit>
#include <string>

#include "core/deform/compiled_parts.h"
#include "tests/core/deform/fixture.h"
#include "tests/support/meshes.h"
#include "tests/support/random.h"

namespace arap::testing {
namespace {

std::vector<PlacedHandle> Placed(const std::vector<std::string>& ids) {
  std::vector<PlacedHandle> handles(ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) handles[i].handle.id = ids[i];
  return handles;
}

// 1,000 ids that begin alike, in no order.
std::vector<std::string> ManyIds() {
  std::vector<std::string> ids;
  for (int i = 0; i < 1000; ++i) ids.push_back("handle_" + std::to_string(i));
  Random(5).Shuffle(ids);
  return ids;
}

TEST(HandleIndexTest, FindsEveryIdWithFewComparisons) {
  const std::vector<std::string> ids = ManyIds();
  const std::vector<PlacedHandle> handles = Placed(ids);
  const HandleIndex index(handles);
  std::size_t comparisons = 0;
  const auto counting = [&](std::string_view a, std::string_view b) {
    ++comparisons;
    return a.compare(b);
  };
  const auto most = static_cast<std::size_t>(std::bit_width(ids.size())) + 1;
  // All of them in another order, as an update may name them.
  for (std::size_t i = ids.size(); i-- > 0;) {
    comparisons = 0;
    EXPECT_EQ(index.Find(handles, ids[i], counting), i);
    EXPECT_LE(comparisons, most);
  }
  for (const char* stranger : {"", "a", "handle_", "handle_1000", "z"}) {
    comparisons = 0;
    EXPECT_EQ(index.Find(handles, stranger, counting), std::nullopt);
    EXPECT_LE(comparisons, most);
  }
}

TEST(HandleIndexTest, OfNoHandlesFindsNothing) {
  const auto compare = [](std::string_view a, std::string_view b) { return a.compare(b); };
  EXPECT_EQ(HandleIndex().Find({}, "a", compare), std::nullopt);
}

TEST(HandleIndexTest, CompiledSetsFindTheirHandlesAlsoAfterEdits) {
  const PlanarMesh mesh = JitteredGrid(6, 6, 2);
  const std::vector<std::string> ids = ManyIds();
  std::vector<Handle> handles = RandomHandles(mesh, 20, 3);
  for (std::size_t i = 0; i < handles.size(); ++i) handles[i].id = ids[i];
  const std::vector<Handle> first(handles.begin(), handles.begin() + 12);
  const std::vector<Handle> added(handles.begin() + 12, handles.end());
  const auto set = Compile(Register(mesh), first);
  const auto edited = Must(set->Edit(std::vector<std::string>{ids[3], ids[0]}, added));
  for (const auto& each : {set, edited}) {
    for (std::size_t i = 0; i < each->handles().size(); ++i) {
      EXPECT_EQ(each->Find(each->handles()[i].handle.id), i);
    }
  }
  EXPECT_EQ(edited->Find(ids[3]), std::nullopt);
  EXPECT_EQ(set->Find(ids[12]), std::nullopt);
}

}  // namespace
}  // namespace arap::testing
