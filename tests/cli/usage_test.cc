// The command line itself: help, versions, usage errors, files that are wrong.
#include <gmock/gmock.h>

#include "tests/cli/run.h"

namespace arap::cli {
namespace {

using testing::HasSubstr;

class Usage : public FolderTest {};

TEST_F(Usage, Version) {
  const Outcome outcome = Arapctl({"--version"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_TRUE(outcome.out.starts_with("arapctl ")) << outcome.out;
}

TEST_F(Usage, HelpOfEveryCommand) {
  EXPECT_EQ(Arapctl({"--help"}).code, 0);
  for (const char* command :
       {"info", "bake", "drag", "flatten", "load", "token", "sample", "figures"}) {
    EXPECT_THAT(Arapctl({"--help"}).out, HasSubstr(command));
    const Outcome outcome = Arapctl({command, "--help"});
    EXPECT_EQ(outcome.code, 0) << command;
    EXPECT_THAT(outcome.out, HasSubstr("Usage: arapctl " + std::string(command)));
  }
}

TEST_F(Usage, WrongCommandLinesEndWithTwo) {
  const std::vector<std::vector<std::string>> wrong{
      {},
      {"fly"},
      {"bake"},
      {"info"},                                // neither --server nor --spawn
      {"info", "--spawn", "--server", "a:1"},  // both
      // Secrets are in files or the environment: every user of the machine sees command lines.
      {"info", "--server", "a:1", "--token", "t"},
      {"bake", "a.obj", "b.json", "--spawn", "--out", "c", "--timeout", "0"},
      {"drag", "a.obj", "b.json", "--spawn", "--timeout", "nan"},
      {"bake", "a.obj", "b.json", "--spawn"},  // no --out
      {"bake", "a.obj", "b.json", "--spawn", "--out", "c", "--basis", "cube"},
      {"bake", "a.obj", "b.json", "--spawn", "--out", "c", "--as-published", "--basis", "edge"},
      {"drag", "a.obj", "b.json", "--spawn", "--pick", "1"},
      {"drag", "a.obj", "b.json", "--spawn", "--pick", "1,b"},
      {"drag", "a.obj", "b.json", "--spawn", "--pick", "1,2,3"},
      {"drag", "a.obj", "b.json", "--spawn", "--pick", "nan,2"},
      {"flatten", "a.obj", "--spawn", "--out", "b.obj", "--basis", "vertex"},
      {"flatten", "a.obj", "--spawn"},  // nothing to write
      {"flatten", "a.obj", "--spawn", "--out", "b.obj", "--method", "magic"},
      {"flatten", "a.obj", "--spawn", "--out", "b.obj", "--grain", "1"},
      {"load", "--spawn", "--streams", "0"},
      {"sample", "dragon", "--out", "a.obj"},
      {"sample", "character"},
      {"sample", "garment", "--out", "a.obj", "--track", "a.json"},
  };
  for (const auto& arguments : wrong) {
    const Outcome outcome = Arapctl(arguments);
    EXPECT_EQ(outcome.code, 2) << testing::PrintToString(arguments);
    EXPECT_NE(outcome.err, "") << testing::PrintToString(arguments);
    EXPECT_EQ(outcome.out, "");
  }
}

TEST_F(Usage, MissingAndBadFilesAreNamed) {
  const Outcome missing =
      Arapctl({"bake", Path("none.obj"), Path("none.json"), "--spawn", "--out", Path("c.csv")});
  EXPECT_EQ(missing.code, 1);
  EXPECT_THAT(missing.err, HasSubstr("none.obj"));

  const std::string square = Put("quad.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  const Outcome quad = Arapctl({"flatten", square, "--spawn", "--out", Path("c.obj")});
  EXPECT_EQ(quad.code, 1);
  EXPECT_THAT(quad.err, HasSubstr("not a triangle mesh"));
}

TEST_F(Usage, AnAbsentServerIsAFailure) {
  const Outcome outcome = Arapctl({"info", "--server", "unix:" + Path("nobody.sock")});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("Cannot reach"));
}

TEST_F(Usage, SamplesThatCannotBeWritten) {
  const Outcome outcome = Arapctl({"sample", "grid", "--out", Path("no/such/folder.obj")});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("cannot write"));
}

}  // namespace
}  // namespace arap::cli
