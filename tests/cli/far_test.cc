// What bake and drag write of a puppet that lies where the metres of a map are: the same as at the
// origin.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "client/cli/sample/samples.h"
#include "core/files/mesh_file.h"
#include "core/files/obj_writer.h"
#include "core/files/track.h"
#include "tests/cli/run.h"

namespace arap::cli {
namespace {

constexpr double kMapX = 5e5, kMapY = 5.4e6;
constexpr double kPuppetSize = 200;

class FarAway : public FolderTest {
 protected:
  void SetUp() override {
    PutPuppet("near", {});
    PutPuppet("far", {kMapX, kMapY});
  }

  void PutPuppet(const std::string& name, Complex at) const {
    PlanarMesh mesh = MakeCharacter(8);
    Track track = MakeCharacterTrack(mesh);
    track.frames.resize(20);
    for (Complex& vertex : mesh.vertices) vertex += at;
    for (TrackHandle& handle : track.handles) {
      handle.rest += at;
      if (auto* point = std::get_if<PointAnchor>(&handle.handle.anchor)) point->position += at;
    }
    for (TrackFrame& frame : track.frames) {
      for (Target& target : frame.targets) target.position += at;
    }
    Put(name + ".obj", FormatObj(mesh));
    Put(name + ".json", FormatTrack(track));
  }

  Outcome On(const std::string& name, std::vector<std::string> command) const {
    command.insert(command.begin() + 1, {Path(name + ".obj"), Path(name + ".json"), "--spawn"});
    const Outcome outcome = Arapctl(command);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome;
  }

  // The numbers of every path and circle of a picture.
  std::vector<long> Drawn(const std::string& file) const {
    const std::string text = Slurp(Path(file));
    std::vector<long> numbers;
    for (const std::string start : {" d=\"", " values=\"", " cx=\"", " cy=\""}) {
      for (auto at = text.find(start); at != std::string::npos; at = text.find(start, at + 1)) {
        const std::string drawn =
            text.substr(at + start.size(), text.find('"', at + start.size()) - at - start.size());
        for (const char* next = drawn.c_str(); *next != '\0';) {
          char* end = nullptr;
          const long number = std::strtol(next, &end, 10);
          if (end != next) numbers.push_back(number);
          next = end != next ? end : next + 1;
        }
      }
    }
    return numbers;
  }

  void ExpectSamePictures(const std::string& one, const std::string& other) const {
    const std::vector<long> near = Drawn(one), far = Drawn(other);
    ASSERT_GT(near.size(), 1000u);
    ASSERT_EQ(near.size(), far.size());
    std::size_t otherwise = 0;
    for (std::size_t i = 0; i < near.size(); ++i) {
      // Differences of two rounded places.
      ASSERT_LE(std::abs(near[i] - far[i]), 2) << i;
      if (near[i] != far[i]) ++otherwise;
    }
    EXPECT_LT(otherwise, near.size() / 200);
  }
};

TEST_F(FarAway, BakeAndDragWriteTheShapesOfTheOrigin) {
  for (const std::string command : {"bake", "drag"}) {
    std::vector<Csv> shapes;
    for (const std::string name : {"near", "far"}) {
      std::vector<std::string> words{command, "--out", Path(name + ".csv"), "--frames-svg",
                                     Path(name + ".svg")};
      if (command == "drag") words.insert(words.end(), {"--delivery", "every"});
      On(name, words);
      shapes.push_back(ParseCsv(Slurp(Path(name + ".csv"))));
    }
    ASSERT_EQ(shapes[0].rows.size(), 20u);
    ASSERT_EQ(shapes[1].rows.size(), 20u);
    for (std::size_t i = 0; i < 20; ++i) {
      const auto &near = shapes[0].rows[i], &far = shapes[1].rows[i];
      ASSERT_EQ(near.size(), far.size());
      for (std::size_t k = 0; k < near.size(); ++k) {
        ASSERT_NEAR(far[k] - (k % 2 == 0 ? kMapX : kMapY), near[k], 1e-6 * kPuppetSize) << command;
      }
    }
    ExpectSamePictures("near.svg", "far.svg");
  }
}

TEST_F(FarAway, PicturesOfALiveDragAreThoseOfTheOrigin) {
  // Without --out positions come in single precision.
  for (const std::string name : {"near", "far"}) {
    On(name, {"drag", "--delivery", "every", "--svg", Path(name + ".svg"), "--frames-svg",
              Path(name + "_frames.svg")});
  }
  ExpectSamePictures("near.svg", "far.svg");
  ExpectSamePictures("near_frames.svg", "far_frames.svg");
}

TEST_F(FarAway, PicksAreToldAsFinely) {
  const std::string square = Put("square.obj",
                                 "v 500000 5400000 0\nv 500002 5400000 0\n"
                                 "v 500002 5400002 0\nv 500000 5400002 0\nf 1 2 3\nf 1 3 4\n");
  const std::string track = Put("square.json", R"({
    "handles": [{"name": "a", "rest": [500000, 5400000]}, {"name": "b", "rest": [500002, 5400002]}],
    "frames": [{"targets": [[500010, 5400000], [500012, 5400002]]}]})");
  const Outcome outcome = Arapctl(
      {"drag", square, track, "--spawn", "--delivery", "every", "--pick", "500011.5,5400000.25"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(
      outcome.out,
      ::testing::HasSubstr("\npick 500011.5,5400000.25: rest 500001.5,5400000.25 in triangle 0\n"));
}

}  // namespace
}  // namespace arap::cli
