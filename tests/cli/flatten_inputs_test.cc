// Seams, pins, rigidity and grain lines as they are written in files and on the command line.
#include "client/cli/commands/flatten_inputs.h"

#include <numbers>

#include <gmock/gmock.h>

#include "client/cli/commands/flatten_flags.h"

namespace arap::cli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::size_t kVertices = 9, kTriangles = 3;

auto Edge(std::uint32_t from, std::uint32_t to) { return ElementsAre(from, to); }

std::string SeamFault(const std::string& text) {
  const auto seams = ParseSeams(text, "s.txt", kVertices);
  return seams ? "no fault" : seams.error().message;
}

std::string PinFault(const std::string& text) {
  const auto pins = ParsePins(text, "p.txt", kVertices);
  return pins ? "no fault" : pins.error().message;
}

TEST(Seams, LinesArePathsOfVerticesFromOne) {
  const auto seams =
      ParseSeams("# along the back\n1 2\n\n  3 4 9   # a path\r\n", "s.txt", kVertices);
  ASSERT_TRUE(seams) << seams.error().message;
  EXPECT_THAT(*seams, ElementsAre(Edge(0, 1), Edge(2, 3), Edge(3, 8)));
  const auto none = ParseSeams("# nothing\n", "s.txt", kVertices);
  ASSERT_TRUE(none);
  EXPECT_THAT(*none, IsEmpty());
}

TEST(Seams, JsonCountsFromZeroInAnyOfItsForms) {
  for (const char* text : {"[[0, 1], [2, 8]]", " [0, 1, 2, 8]",
                           "{\"vertices\": 9, \"cut_edges\": [[0, 1], [2, 8]]}"}) {
    const auto seams = ParseSeams(text, "s.json", kVertices);
    ASSERT_TRUE(seams) << seams.error().message;
    EXPECT_THAT(*seams, ElementsAre(Edge(0, 1), Edge(2, 8))) << text;
  }
}

TEST(Seams, FaultsNameTheLine) {
  EXPECT_EQ(SeamFault("1 2\n\n0 1\n"), "s.txt:3: vertex 0: vertices count from 1");
  EXPECT_EQ(SeamFault("1 10\n"), "s.txt:1: vertex 10: the surface has 9");
  EXPECT_EQ(SeamFault("1 two\n"), "s.txt:1: 'two' is not a whole number");
  EXPECT_EQ(SeamFault("#\n7\n"), "s.txt:2: a seam goes from one vertex to another");
  EXPECT_EQ(SeamFault("\xff\xfe"), "s.txt: the text is in UTF-16; save it as UTF-8");
}

TEST(Seams, JsonFaultsNameTheElement) {
  EXPECT_EQ(SeamFault("[[0, 1], [2]]"), "s.txt:1:10: element 1: [2] is not a pair of vertices");
  EXPECT_EQ(SeamFault("[[0, 1],\n [0, 9]]"),
            "s.txt:2:2: element 1: 9 is not a vertex: they go from 0 to 8");
  EXPECT_EQ(SeamFault("{\"cut_edges\":\n[0, 1, 2, 9]}"),
            "s.txt:2:11: element 3: 9 is not a vertex: they go from 0 to 8");
  EXPECT_THAT(SeamFault("[[0, -1]]"), HasSubstr("-1 is not a vertex"));
  EXPECT_THAT(SeamFault("[0, 1, 2]"), HasSubstr("3 vertices do not make pairs"));
  EXPECT_EQ(SeamFault("[0, 1"), "s.txt:1:6: not JSON: unexpected end of input; expected ']'");
  EXPECT_THAT(SeamFault("{\"edges\": []}"), HasSubstr("cut_edges"));
}

TEST(Pins, LinesAreVertexPlaceAndWeight) {
  const auto pins = ParsePins("1 0.5 -2e1 # a corner\n9 1 1 100\n", "p.txt", kVertices);
  ASSERT_TRUE(pins) << pins.error().message;
  ASSERT_EQ(pins->size(), 2u);
  EXPECT_EQ((*pins)[0].vertex, 0u);
  EXPECT_EQ((*pins)[0].uv, Complex(0.5, -20));
  EXPECT_EQ((*pins)[0].weight, 0);
  EXPECT_EQ((*pins)[1].vertex, 8u);
  EXPECT_EQ((*pins)[1].weight, 100);
}

TEST(Pins, FaultsNameTheLine) {
  EXPECT_EQ(PinFault("1 0 0\n2 0\n"), "p.txt:2: a pin is 'vertex u v [weight]', these are 2 words");
  EXPECT_THAT(PinFault("1 0 0 1 1\n"), HasSubstr("p.txt:1: a pin is"));
  EXPECT_EQ(PinFault("1 0 here\n"), "p.txt:1: 'here' is not a number");
  EXPECT_THAT(PinFault("1 0 0 -1\n"), HasSubstr("p.txt:1: a weight is not negative"));
  EXPECT_EQ(PinFault("\n10 0 0\n"), "p.txt:2: vertex 10: the surface has 9");
}

std::string RigidityFault(const std::string& text) {
  const auto rigidity = ParseRigidity(text, "r.txt", kTriangles);
  return rigidity ? "no fault" : rigidity.error().message;
}

TEST(Rigidity, IsANumberPerTriangle) {
  for (const char* text :
       {"# stiff at the waist\n1\n\n 2.5e1 # here\n1e6\r\n", "1\r25\r1e6", "[1, 25, 1e6]"}) {
    const auto rigidity = ParseRigidity(text, "r.txt", kTriangles);
    ASSERT_TRUE(rigidity) << rigidity.error().message;
    EXPECT_THAT(*rigidity, ElementsAre(1, 25, 1e6)) << text;
  }
}

TEST(Rigidity, FaultsNameTheLineAndTheLimit) {
  EXPECT_EQ(RigidityFault("1\n\nstiff\n1\n"), "r.txt:3: 'stiff' is not a number");
  EXPECT_EQ(RigidityFault("1\nnan\n1\n"), "r.txt:2: 'nan' is not a finite number");
  EXPECT_EQ(RigidityFault("1 1 1\n"), "r.txt:1: a line has one rigidity, these are 3 words");
  EXPECT_EQ(RigidityFault("1\n0\n1\n"),
            "r.txt:2: a rigidity of 0 is not above 0 and at most 1000000");
  EXPECT_THAT(RigidityFault("1\n1\n-2\n"), HasSubstr("r.txt:3: a rigidity of -2 is not above 0"));
  EXPECT_THAT(RigidityFault("1\n1\n1000001\n"), HasSubstr("at most 1000000"));
  EXPECT_EQ(RigidityFault("1\n1\n"),
            "r.txt: 2 numbers; the surface has 3 triangles, and each needs one");
  EXPECT_THAT(RigidityFault(""), HasSubstr("r.txt: 0 numbers; the surface has 3"));
}

TEST(Rigidity, JsonFaultsNameTheElementAndTheLimit) {
  EXPECT_EQ(RigidityFault("[1, \"stiff\", 1]"), "r.txt:1:5: element 1: \"stiff\" is not a number");
  EXPECT_EQ(RigidityFault("[1, 1, 2e6]"),
            "r.txt:1:8: element 2: a rigidity of 2000000 is not above 0 and at most 1000000");
  EXPECT_THAT(RigidityFault("[1, 1, 1, 1]"), HasSubstr("4 numbers; the surface has 3 triangles"));
  EXPECT_THAT(RigidityFault("[1, 1"), HasSubstr("not JSON"));
  EXPECT_THAT(RigidityFault("{\"rigidity\": 1}"), HasSubstr("not an array of numbers"));
}

TEST(Grain, IsTwoVerticesAndPerhapsAnAngle) {
  const auto line = ParseGrain("3,7");
  ASSERT_TRUE(line) << line.error().message;
  EXPECT_EQ(line->from, 2u);
  EXPECT_EQ(line->to, 6u);
  EXPECT_EQ(line->angle, 0);
  const auto turned = ParseGrain("3,7,-45.5");
  ASSERT_TRUE(turned);
  EXPECT_DOUBLE_EQ(turned->angle, -45.5 * std::numbers::pi / 180);
  for (const char* bad : {"", "3", "3,", "3,7,", "3,7,up", "3,7,1,2", "a,7", "0,7", "3,7,nan"}) {
    EXPECT_FALSE(ParseGrain(bad)) << bad;
  }
  EXPECT_TRUE(CheckGrain(*line, 7));
  EXPECT_EQ(CheckGrain(*line, 6).error().message, "--grain: vertex 7: the surface has 6");
}

// The flags as a command line gives them.
Result<FlattenFlags> Parse(std::vector<std::string> words) {
  CLI::App app;
  FlattenFlags flags;
  AddFlattenFlags(app, flags);
  words.insert(words.begin(), {"a.obj", "--spawn"});
  std::reverse(words.begin(), words.end());  // as CLI11 wants them
  try {
    app.parse(words);
  } catch (const CLI::ParseError& error) {
    return Fail(FaultKind::kInvalidOption, error.what());
  }
  return flags;
}

TEST(FlattenFlags, SayWhatTheyAreCalled) {
  const auto flags = Parse({"--out",
                            "b.obj",
                            "--method",
                            "arap-edge",
                            "--weights",
                            "uniform",
                            "--basis",
                            "edge-as-published",
                            "--anchors",
                            "far-boundary",
                            "--refine",
                            "7",
                            "--refine-stop",
                            "0.01",
                            "--injective",
                            "--auto-cut",
                            "--surface-key",
                            "skirt",
                            "--split-non-manifold",
                            "--tolerate-degenerate",
                            "--unit",
                            "in",
                            "--grain",
                            "1,2",
                            "--grain",
                            "3,4,90",
                            "--timeout",
                            "1.5",
                            "--allowance",
                            "10"});
  ASSERT_TRUE(flags) << flags.error().message;
  EXPECT_EQ(flags->drawing.options.millimetres_per_unit, 25.4);
  EXPECT_EQ(flags->drawing.options.allowance, 10);
  EXPECT_EQ(flags->timeout.value(), std::chrono::milliseconds(1500));
  const auto query = ReadQuery(*flags, {}, kVertices, kTriangles);
  ASSERT_TRUE(query) << query.error().message;
  const FlattenOptions& options = query->options;
  EXPECT_EQ(options.method, FlattenMethod::kArap);
  EXPECT_EQ(options.energy.weights, Weights::kUniform);
  EXPECT_EQ(options.energy.basis, Basis::kEdgeAsPublished);
  EXPECT_EQ(options.anchors, FlattenAnchors::kFarBoundary);
  EXPECT_EQ(options.refine, 7);
  EXPECT_EQ(options.refine_stop, 0.01);
  EXPECT_TRUE(options.injective && options.cut.auto_cut && options.cut.split_non_manifold &&
              options.cut.tolerate_degenerate);
  EXPECT_EQ(query->surface_key, "skirt");
  ASSERT_EQ(options.grain_lines.size(), 2u);
  EXPECT_EQ(options.grain_lines[1].from, 2u);
  EXPECT_DOUBLE_EQ(options.grain_lines[1].angle, std::numbers::pi / 2);
}

TEST(FlattenFlags, MethodsAreTheServicesPresets) {
  const std::pair<const char*, FlattenOptions> methods[] = {
      {"arap-edge", ArapOptions(Basis::kEdge)},
      {"arap-face", ArapOptions()},
      {"lscm", LscmOptions()},
      {"first-step", FirstStepOptions()},
      {"abf", AbfOptions()},
  };
  for (const auto& [name, preset] : methods) {
    const auto flags = Parse({"--out", "b.obj", "--method", name});
    ASSERT_TRUE(flags) << flags.error().message;
    const auto options = flags->method.Options();
    ASSERT_TRUE(options) << options.error().message;
    EXPECT_EQ(*options, preset) << name;
  }
}

TEST(FlattenFlags, RefuseWhatDoesNotGoWithTheMethod) {
  const std::pair<std::vector<std::string>, const char*> wrong[] = {
      {{"--method", "lscm", "--basis", "edge"}, "energy.basis"},
      {{"--method", "arap-edge", "--basis", "face"}, "energy.basis"},
      {{"--method", "abf", "--weights", "uniform"}, "energy.weights"},
  };
  for (const auto& [words, field] : wrong) {
    std::vector<std::string> all{"--out", "b.obj"};
    all.insert(all.end(), words.begin(), words.end());
    const auto flags = Parse(all);
    ASSERT_TRUE(flags) << flags.error().message;
    const auto options = flags->method.Options();
    ASSERT_FALSE(options);
    EXPECT_EQ(options.error().kind, FaultKind::kInvalidOption);
    EXPECT_EQ(options.error().field, field);
  }
}

TEST(FlattenFlags, LeaveEverythingElseToTheService) {
  const auto flags = Parse({"--dxf", "b.dxf"});
  ASSERT_TRUE(flags) << flags.error().message;
  const auto query = ReadQuery(*flags, {}, kVertices, kTriangles);
  ASSERT_TRUE(query) << query.error().message;
  EXPECT_EQ(query->options, ArapOptions());
  EXPECT_EQ(flags->drawing.options.millimetres_per_unit, 1);
  EXPECT_EQ(flags->timeout.value(), std::chrono::minutes(10));
}

TEST(FlattenFlags, RefuseWhatTheyDoNotKnow) {
  const std::vector<std::vector<std::string>> wrong{
      {},  // nothing to write
      {"--out", "b.obj", "--method", "magic"},
      {"--out", "b.obj", "--anchors", "middle"},
      {"--out", "b.obj", "--unit", "parsec"},
      {"--out", "b.obj", "--grain", "1"},
      {"--out", "b.obj", "--grain", "0,1"},
      {"--out", "b.obj", "--timeout", "0"},
      {"--out", "b.obj", "--timeout", "nan"},
      {"--out", "b.obj", "--allowance", "-1"},
      {"--out", "b.obj", "--refine-stop", "2"},
      {"--out", "b.obj", "--refine-stop", "nan"},
      {"--out", "b.obj", "--refine", "-1"},
      {"--out", "b.obj", "--basis", "vertex"},
  };
  for (const auto& words : wrong) EXPECT_FALSE(Parse(words)) << testing::PrintToString(words);
}

}  // namespace
}  // namespace arap::cli
