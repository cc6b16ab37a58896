// "-" is standard input or output, and --json answers one document, of errors too.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/cli/png.h"
#include "tests/cli/run.h"

namespace arap::cli {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

nlohmann::json Parse(const std::string& text) {
  auto json = nlohmann::json::parse(text, nullptr, false);
  EXPECT_FALSE(json.is_discarded()) << text;
  return json;
}

class StandardStreams : public FolderTest {
 protected:
  void SetUp() override {
    ASSERT_EQ(Arapctl({"sample", "grid", "--size", "5", "--out", Path("grid.obj"), "--track",
                       Path("grid.json")})
                  .code,
              0);
  }
};

TEST_F(StandardStreams, AreReadAndWrittenEverywhere) {
  const std::string mesh = Slurp(Path("grid.obj")), track = Slurp(Path("grid.json"));
  EXPECT_EQ(Arapctl({"sample", "grid", "--size", "5", "--out", "-"}).out, mesh);

  const Outcome baked = Arapctl({"bake", "-", Path("grid.json"), "--spawn", "--out", "-"}, mesh);
  ASSERT_EQ(baked.code, 0) << baked.err;
  EXPECT_THAT(baked.out, StartsWith("frame,x0,y0,"));
  EXPECT_THAT(baked.out, Not(HasSubstr("registered in")));
  EXPECT_THAT(baked.err, HasSubstr("registered in")) << "what is for people goes elsewhere";
  const Outcome piped =
      Arapctl({"bake", Path("grid.obj"), "-", "--spawn", "--out", Path("a.csv")}, track);
  ASSERT_EQ(piped.code, 0) << piped.err;
  EXPECT_EQ(Slurp(Path("a.csv")), baked.out);

  const Outcome flat = Arapctl({"flatten", "-", "--spawn", "--out", "-"}, mesh);
  ASSERT_EQ(flat.code, 0) << flat.err;
  EXPECT_THAT(flat.out, HasSubstr("\nvt "));
  const Outcome report =
      Arapctl({"flatten", Path("grid.obj"), "--spawn", "--pins", "-", "--report", "-"}, "1 0 0\n");
  ASSERT_EQ(report.code, 0) << report.err;
  EXPECT_TRUE(Parse(report.out).contains("vertices")) << report.out.substr(0, 300);
  const Outcome off = Arapctl({"flatten", "-", "--spawn", "--report", Path("r.json")},
                              "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  EXPECT_EQ(off.code, 0) << off.err;

  const Outcome times =
      Arapctl({"drag", Path("grid.obj"), Path("grid.json"), "--spawn", "--json", "-"});
  ASSERT_EQ(times.code, 0) << times.err;
  EXPECT_GT(Parse(times.out)["answered"], 0);
}

TEST_F(StandardStreams, FlattenAndSampleAnswerInJson) {
  const Outcome flat = Arapctl({"flatten", Path("grid.obj"), "--spawn", "--json", "--report",
                                Path("r.json"), "--compare", Path("c.svg")});
  ASSERT_EQ(flat.code, 0) << flat.err;
  nlohmann::json document = Parse(flat.out);
  EXPECT_EQ(document["vertices"], 25);
  EXPECT_EQ(document["distortion"]["flipped"], 0);
  ASSERT_EQ(document["comparison"].size(), 6u);
  EXPECT_EQ(document["comparison"][0]["distortion"]["flipped"], 0);
  document.erase("comparison");
  EXPECT_EQ(document, Parse(Slurp(Path("r.json"))));

  const Outcome sample = Arapctl({"sample", "grid", "--size", "4", "--out", Path("s.obj"),
                                  "--track", Path("s.json"), "--json"});
  ASSERT_EQ(sample.code, 0) << sample.err;
  const nlohmann::json made = Parse(sample.out);
  EXPECT_EQ(made["mesh"], Path("s.obj"));
  EXPECT_EQ(made["vertices"], 16);
  EXPECT_EQ(made["track"], Path("s.json"));
  EXPECT_EQ(made["frames"], 60);

  Put("bad.obj", "v 0 0 0\nv 1 0 0\nf 1 2 9\n");
  const Outcome bad = Arapctl({"flatten", Path("bad.obj"), "--spawn", "--json"});
  EXPECT_EQ(bad.code, 3);
  EXPECT_EQ(Parse(bad.out)["error"]["class"], "refused");
}

TEST_F(StandardStreams, AnImageComesThroughThemToo) {
  const std::string image = DrawnPng(40, 40, [](double x, double y) {
    const bool inside = x > 8 && x < 32 && y > 8 && y < 32;
    return Pixel{0, 0, 0, static_cast<std::uint8_t>(inside ? 255 : 0)};
  });
  Put("figure.png", image);
  const Outcome file = Arapctl({"mesh", Path("figure.png"), "--out", "-", "--density", "50"});
  ASSERT_EQ(file.code, 0) << file.err;
  EXPECT_EQ(Arapctl({"mesh", "-", "--out", "-", "--density", "50"}, image).out, file.out);
  const Outcome none = Arapctl({"mesh", "-", "--out", "-"}, "no image");
  EXPECT_EQ(none.code, 3);
  EXPECT_EQ(none.out, "");
}

TEST_F(StandardStreams, AreForOneFileEach) {
  const Outcome outputs =
      Arapctl({"bake", Path("grid.obj"), Path("grid.json"), "--spawn", "--out", "-", "--svg", "-"});
  EXPECT_EQ(outputs.code, 2);
  EXPECT_THAT(outputs.err, HasSubstr("--svg: standard output is for another option"));
  const std::vector<std::string> both{
      "bake", Path("grid.obj"), Path("grid.json"), "--spawn", "--out", "-", "--json"};
  EXPECT_EQ(Arapctl(both).code, 2);
  const Outcome inputs =
      Arapctl({"bake", "-", "-", "--spawn", "--out", Path("a.csv")}, Slurp(Path("grid.obj")));
  EXPECT_EQ(inputs.code, 3);
  EXPECT_THAT(inputs.err, HasSubstr("one file, not for two"));
}

TEST_F(StandardStreams, AnswersInJsonAreOneDocument) {
  const Outcome info = Arapctl({"info", "--spawn", "--json"});
  ASSERT_EQ(info.code, 0) << info.err;
  EXPECT_GT(Parse(info.out)["limits"]["max_vertices"], 0);
  const Outcome baked = Arapctl(
      {"bake", Path("grid.obj"), Path("grid.json"), "--spawn", "--out", Path("a.csv"), "--json"});
  ASSERT_EQ(baked.code, 0) << baked.err;
  EXPECT_EQ(Parse(baked.out)["vertices"], 25);
  EXPECT_EQ(Parse(baked.out)["warnings"].is_null(), true);

  const std::string tokens = Path("tokens.json");
  const auto token =
      Parse(Arapctl({"token", "add", "--file", tokens, "--owner", "ann", "--json"}).out);
  const auto list = Parse(Arapctl({"token", "list", "--file", tokens, "--json"}).out);
  ASSERT_EQ(list["tokens"].size(), 1u);
  EXPECT_EQ(list["tokens"][0]["id"], token["id"]);
  EXPECT_EQ(list["tokens"][0]["expires"], "never");
  EXPECT_EQ(Parse(Arapctl({"token", "revoke", "--file", tokens, "--owner", "ann", "--json"})
                      .out)["revoked"],
            1);
}

TEST_F(StandardStreams, WarningsAndErrorsAreInTheDocument) {
  const std::string bad = Put("bad.obj", "v 0 0\nv 1 0\nv 0 1\nv 2 0\nhair 7\nf 1 2 3\nf 1 2 4\n");
  const Outcome refused =
      Arapctl({"bake", bad, Path("grid.json"), "--spawn", "--out", Path("a.csv"), "--json"});
  EXPECT_EQ(refused.code, 3);
  EXPECT_THAT(refused.err, HasSubstr("DEGENERATE_TRIANGLE"));
  const auto error = Parse(refused.out)["error"];
  EXPECT_EQ(error["exit_code"], 3);
  EXPECT_EQ(error["class"], "refused");
  EXPECT_EQ(error["reason"], "DEGENERATE_TRIANGLE");
  EXPECT_THAT(error["message"].get<std::string>(), HasSubstr("bad.obj"));
  EXPECT_EQ(Parse(refused.out)["warnings"][0]["kind"], "unknown_statements");

  const Outcome absent = Arapctl({"info", "--server", "unix:" + Path("none"), "--json"});
  EXPECT_EQ(Parse(absent.out)["error"]["class"], "unavailable");
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"info", "--json", "--sever"},
        {"info", "--json"},
        {"token", "list", "--json"}}) {
    const Outcome usage = Arapctl(words);
    EXPECT_EQ(usage.code, 2);
    EXPECT_EQ(Parse(usage.out)["error"]["class"], "usage") << usage.out;
  }
  const Outcome drag = Arapctl({"drag", bad, Path("grid.json"), "--spawn", "--json", "-"});
  EXPECT_EQ(drag.code, 3);
  EXPECT_EQ(Parse(drag.out)["error"]["reason"], "DEGENERATE_TRIANGLE");
}

}  // namespace
}  // namespace arap::cli
