// Flatten over the wire: the surfaces of the folder that ARAP_TEST_DATA names, good and bad.
#include <filesystem>
#include <string>

#include <gmock/gmock.h>

#include "tests/support/obj.h"
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
