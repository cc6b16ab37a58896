// Repairs over the wire, through the client library.
#include <algorithm>
#include <string>

#include <gmock/gmock.h>

#include "arap/client/client.h"
#include "tests/support/must.h"
#include "tests/system/wire/flatten_fixture.h"

namespace arap::wire::mended {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::Must;
using ::testing::SizeIs;

std::vector<std::string> KindsOf(const std::vector<Warning>& warnings) {
  std::vector<std::string> kinds;
  for (const Warning& warning : warnings) kinds.push_back(warning.kind);
  return kinds;
}

// BentStrip with vertices of its own for every triangle.
SurfaceMesh Soup() {
  const SurfaceMesh strip = BentStrip();
  SurfaceMesh soup;
  for (const Triangle& t : strip.triangles) {
    const auto v = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t corner : t) soup.vertices.push_back(strip.vertices[corner]);
    soup.triangles.push_back({v, v + 1, v + 2});
  }
  return soup;
}

class RepairTest : public FlattenTest {
 protected:
  client::Client Connect() { return client::Client::Connect(host().addresses().front()); }
};

TEST_F(RepairTest, FlattenMendsAndSpeaksOfWhatWasSent) {
  const SurfaceMesh soup = Soup();
  client::FlattenQuery query;
  query.float64 = query.singular_values = true;
  const auto open = Must(Connect().Flatten(soup, query));
  EXPECT_THAT(open.flat.charts, SizeIs(soup.triangles.size()));
  EXPECT_THAT(KindsOf(open.flat.warnings), ElementsAre("twin_vertices"));
  for (const std::string key : {"", "soup", "soup"}) {
    query.surface_key = key;
    query.options.cut.repair.weld = true;
    const auto welded = Must(Connect().Flatten(soup, query));
    EXPECT_THAT(welded.flat.charts, SizeIs(1));
    EXPECT_THAT(welded.flat.welded, SizeIs(soup.vertices.size()));
    EXPECT_THAT(KindsOf(welded.flat.warnings), ElementsAre("welded_vertices"));
    EXPECT_EQ(welded.flat.singular_values.size(), soup.triangles.size());
  }
  query.options.cut.repair.tolerance = -1;
  const auto fault = Connect().Flatten(soup, query);
  ASSERT_FALSE(fault);
  EXPECT_EQ(fault.error().kind, FaultKind::kInvalidOption);
  EXPECT_EQ(fault.error().field, "repair.tolerance");
}

TEST_F(RepairTest, MeshesAreMendedAndSpokenOfAsTheyWereSent) {
  // Two squares with vertices of their own where they meet.
  const PlanarMesh mesh{{{0, 0}, {1, 0}, {0, 1}, {1, 1}, {1, 0}, {2, 0}, {1, 1}, {2, 1}},
                        {{0, 1, 3}, {0, 3, 2}, {4, 5, 7}, {4, 7, 6}}};
  const auto session = Must(Connect().CreateSession({"s", {}, {}}));
  const auto torn = Must(session.RegisterMesh(mesh, {}, "torn"));
  EXPECT_EQ(torn.mesh.report.components, 2u);
  EXPECT_THAT(KindsOf(torn.mesh.report.warnings), ElementsAre("twin_vertices"));
  EXPECT_THAT(torn.mesh.report.warnings[0].message, HasSubstr("weld"));
  const RepairOptions repairs{.weld = true, .tolerance = 1e-3};
  const auto mended = Must(session.RegisterMesh(mesh, {}, "mended", {}, repairs));
  EXPECT_EQ(mended.mesh.report.components, 1u);
  EXPECT_EQ(mended.mesh.repairs, repairs);
  EXPECT_NE(mended.mesh.content_hash, torn.mesh.content_hash);
  // The same name with other repairs is another mesh.
  EXPECT_EQ(session.RegisterMesh(mesh, {}, "mended").error().kind, FaultKind::kAlreadyExists);

  Handle left, right;
  left.id = "left";
  left.anchor = VertexAnchor{2};
  right.id = "right";
  right.anchor = VertexAnchor{6};  // stands for itself no more
  Must(session.CompileHandles("set", "mended", std::vector<Handle>{left, right}));
  const std::vector<HandleTarget> targets{{"left", {{0, 1}, 0, 1}}, {"right", {{1.5, 2}, 0, 1}}};
  const auto shape = Must(session.Deform("set", targets, {.float64 = true}));
  ASSERT_THAT(shape.positions, SizeIs(8));
  EXPECT_EQ(shape.positions[1], shape.positions[4]);
  EXPECT_EQ(shape.positions[3], shape.positions[6]);
  // A pick speaks of the triangles that were sent.
  const Complex point = (shape.positions[4] + shape.positions[7] + shape.positions[6]) / 3.0;
  const auto picked = Must(session.Deform("set", targets, {.float64 = true}, {&point, 1}));
  ASSERT_TRUE(picked.picks[0]);
  EXPECT_EQ(picked.picks[0]->triangle, 3u);

  const auto large = session.RegisterMesh(mesh, {}, "large", {}, {.weld = true, .tolerance = 1});
  ASSERT_FALSE(large);
  EXPECT_EQ(large.error().field, "repair.tolerance");
}

}  // namespace
}  // namespace arap::wire::mended
