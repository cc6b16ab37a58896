// Flatten over the wire: many surfaces, good and bad. Some are made here, the others are those of the
// folder that ARAP_TEST_DATA names.
#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>

#include <gmock/gmock.h>

#include "tests/support/obj.h"
#include "tests/support/surfaces.h"
#include "tests/system/wire/flatten_fixture.h"

namespace arap::wire {
namespace {

using ::testing::ElementsAre;

namespace fs = std::filesystem;

class FlattenDataTest : public FlattenTest {
 protected:
  void SetUp() override {
    const auto data = testing::TestData();
    if (!data) GTEST_SKIP() << "NOT CHECKED: ARAP_TEST_DATA does not name a folder";
    folder_ = *data / "3d";
  }

  v1::FlattenRequest Read(const std::string& name) const {
    const SurfaceMesh mesh = testing::ReadObj(folder_ / name);
    EXPECT_FALSE(mesh.vertices.empty()) << name;
    return RequestFor(mesh);
  }

  void Bad(const char* name, const char* reason, const char* elements) {
    SCOPED_TRACE(name);
    const WireError error =
        Refusal(Read(std::string("bad/") + name + ".obj"), grpc::INVALID_ARGUMENT, reason);
    const auto found = error.metadata.find("elements");
    EXPECT_EQ(found == error.metadata.end() ? "" : found->second, elements) << error.message;
  }

  fs::path folder_;
};

// Two tetrahedra that meet in vertex 0.
SurfaceMesh ClosedHourglass() {
  return {{{0, 0, 0}, {1, 0, 1}, {-1, 1, 1}, {-1, -1, 1}, {1, 0, -1}, {-1, 1, -1}, {-1, -1, -1}},
          {{0, 2, 1}, {0, 3, 2}, {0, 1, 3}, {1, 2, 3}, {0, 4, 5}, {0, 5, 6}, {0, 6, 4}, {4, 6, 5}}};
}

// A cap whose vertices 30 and 31, neighbours in a ring, are at one place: an edge without length.
SurfaceMesh PinchedCap() {
  SurfaceMesh mesh = testing::SphereCap(8, 12, 1.2);
  mesh.vertices[31] = mesh.vertices[30];
  return mesh;
}

TEST_F(FlattenTest, ClosedHourglassAndPinchedCapAreRefusedByName) {
  EXPECT_EQ(Refusal(RequestFor(ClosedHourglass()), grpc::INVALID_ARGUMENT, "NON_MANIFOLD_VERTEX")
                .metadata.at("elements"),
            "0");
  const SurfaceMesh cap = PinchedCap();
  std::string on_the_edge;
  for (std::size_t i = 0; i < cap.triangles.size(); ++i) {
    const Triangle& t = cap.triangles[i];
    if (std::ranges::count(t, 30u) + std::ranges::count(t, 31u) < 2) continue;
    on_the_edge += (on_the_edge.empty() ? "" : ",") + std::to_string(i);
  }
  EXPECT_FALSE(on_the_edge.empty());
  EXPECT_EQ(Refusal(RequestFor(cap), grpc::INVALID_ARGUMENT, "DEGENERATE_TRIANGLE")
                .metadata.at("elements"),
            on_the_edge);
}

TEST_F(FlattenTest, BadSurfacesThatCanBeMendedAreOnRequest) {
  SurfaceMesh flat_triangle = BentStrip();
  flat_triangle.vertices[2] = flat_triangle.vertices[0];
  for (const auto& [name, mesh] : {std::pair{"bowtie", Bowtie()},
                                   {"fan", Fan()},
                                   {"hourglass", ClosedHourglass()},
                                   {"sphere", testing::Sphere(8, 12)},
                                   {"torus", testing::Torus(12, 8, 3, 1)},
                                   {"plate with holes", testing::PlateWithHoles(2, 2)},
                                   {"pinched cap", PinchedCap()},
                                   {"zero area", flat_triangle}}) {
    SCOPED_TRACE(name);
    v1::FlattenRequest request = RequestFor(mesh);
    request.set_auto_cut(true);
    request.set_split_non_manifold(true);
    request.set_tolerate_degenerate(true);
    Flat(request);
  }
}

TEST_F(FlattenTest, EveryGoodSurfaceIsFlattened) {
  for (const auto& [name, mesh] :
       {std::pair{"cap", testing::SphereCap(12, 24, 1.2)},
        {"nearly a sphere", testing::SphereCap(20, 24, 2.8)},
        {"rolled sheet", testing::RolledSheet(20, 12, 4, 2, 0.8, 1).surface},
        {"accordion", testing::Accordion(16, 8, 4, 2, 1.5, 2).surface},
        {"cone", testing::ConePatch(16, 8, 0.2, 2, 2.5, 5, 3).surface},
        {"a cap beside a strip",
         testing::Together(testing::SphereCap(6, 12, 1), BentStrip(), {9, 0, 0})}}) {
    SCOPED_TRACE(name);
    Flat(RequestFor(mesh));
  }
}

TEST_F(FlattenDataTest, EveryBadFileIsRefusedByName) {
  Bad("bowtie_vertex", "NON_MANIFOLD_VERTEX", "0");
  Bad("closed_hourglass", "NON_MANIFOLD_VERTEX", "22");
  Bad("closed_spot", "NOT_A_DISK", "0");
  Bad("degenerate_zero_area", "DEGENERATE_TRIANGLE", "129");
  Bad("degenerate_zero_edge", "DEGENERATE_TRIANGLE", "1700,1703");
  Bad("duplicate_triangle", "DUPLICATE_TRIANGLE", "100,3600");
  Bad("nan_coordinate", "NON_FINITE_COORDINATE", "50");
  Bad("nonmanifold_fan3", "NON_MANIFOLD_EDGE", "0,1,2");
  Bad("nonmanifold_triple_vierbein", "NON_MANIFOLD_EDGE", "0,2,55");
  const v1::FlattenRequest moebius = Read("bad/moebius.obj");
  ExpectNeighbours(
      moebius, Refusal(moebius, grpc::INVALID_ARGUMENT, "NOT_ORIENTABLE").metadata.at("elements"));
  const v1::FlattenResponse last = Flat(Read("bad/unreferenced_vertices.obj"));
  EXPECT_THAT(Kinds(last), ElementsAre("unreferenced_vertices"));
  EXPECT_THAT(last.warnings(0).elements(), ElementsAre(1861, 1862));
  const v1::FlattenResponse middle = Flat(Read("bad/unreferenced_vertices_shuffled.obj"));
  EXPECT_THAT(middle.warnings(0).elements(), ElementsAre(258, 663, 1403));
}

TEST_F(FlattenDataTest, BadFilesThatCanBeMendedAreOnRequest) {
  for (const char* name :
       {"bowtie_vertex", "closed_hourglass", "closed_spot", "degenerate_zero_area",
        "degenerate_zero_edge", "nonmanifold_fan3", "nonmanifold_triple_vierbein"}) {
    SCOPED_TRACE(name);
    v1::FlattenRequest request = Read(std::string("bad/") + name + ".obj");
    request.set_auto_cut(true);
    request.set_split_non_manifold(true);
    request.set_tolerate_degenerate(true);
    Flat(request);
  }
}

TEST_F(FlattenDataTest, EveryGoodFileIsFlattened) {
  int files = 0;
  for (const auto& entry : fs::directory_iterator(folder_)) {
    if (entry.path().extension() != ".obj") continue;
    SCOPED_TRACE(entry.path().filename().string());
    Flat(Read(entry.path().filename().string()));
    ++files;
  }
  EXPECT_GE(files, 14);
}

}  // namespace
}  // namespace arap::wire
