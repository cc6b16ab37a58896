// The command line itself: help, versions, usage errors, files that are wrong.
#include <filesystem>
#include <iterator>

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
       {"info", "bake", "drag", "flatten", "mesh", "load", "token", "sample", "figures"}) {
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
      {"load", "--spawn", "--fps", "10", "--rate", "10"},
      {"load", "--spawn", "--profile", "step:"},
      {"load", "--spawn", "--profile", "step:10", "--search", "p99<1ms"},
      {"load", "--spawn", "--search", "fast"},
      {"load", "--spawn", "--resolution", "5"},
      {"load", "--spawn", "--arrivals", "poisson"},
      {"load", "--spawn", "--mix", "fly=1"},
      {"load", "--spawn", "--handles", "0"},
      {"load", "--spawn", "--window", "5000"},
      {"load", "--spawn", "--mesh", "a.obj", "--vertices", "10"},
      {"load", "--spawn", "--threshold", "p99<20"},
      {"load", "compare", "a.json", "b.json", "--threshold", "p99<20ms"},
      {"mesh", "a.png"},
      {"mesh", "a.png", "--out", "b.obj", "--threshold", "256"},
      {"mesh", "a.png", "--out", "b.obj", "--density", "2"},
      {"mesh", "a.png", "--out", "b.obj", "--expansion", "nan"},
      {"mesh", "a.png", "--out", "b.obj", "--background", "blue"},
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
  EXPECT_EQ(missing.code, 4);
  EXPECT_THAT(missing.err, HasSubstr("none.obj"));

  const std::string path = Put("face.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n");
  const Outcome bad = Arapctl({"flatten", path, "--spawn", "--out", Path("c.obj")});
  EXPECT_EQ(bad.code, 3);
  EXPECT_THAT(bad.err, HasSubstr("face.obj:4: '0'"));
}

TEST_F(Usage, AnAbsentServerIsAFailure) {
  const Outcome outcome = Arapctl({"info", "--server", "unix:" + Path("nobody.sock")});
  EXPECT_EQ(outcome.code, 6);
  EXPECT_THAT(outcome.err, HasSubstr("Cannot reach"));
}

// Before anything is read or connected to: neither the inputs nor the server are there.
TEST_F(Usage, OutputsThatCannotBeWrittenAreAWrongCommandLine) {
  const std::string old = Put("old", "before");
  const std::vector<std::string> bake{"bake", "a.obj", "b.json", "--server", "unix:/nobody"};
  const std::vector<std::string> drag{"drag", "a.obj", "b.json", "--server", "unix:/nobody"};
  const std::vector<std::string> flatten{"flatten", "a.obj", "--server", "unix:/nobody"};
  const std::vector<std::string> load{"load", "--server", "unix:/nobody"};
  const std::vector<std::string> sample{"sample", "character"};
  const std::pair<std::vector<std::string>, std::vector<const char*>> commands[] = {
      {bake, {"--out", "--svg", "--frames-svg"}},
      {drag, {"--out", "--svg", "--frames-svg", "--json"}},
      {flatten, {"--out", "--svg", "--dxf", "--report", "--compare"}},
      {load, {"--json", "--csv", "--html"}},
      {sample, {"--out", "--track"}},
      {{"mesh", "a.png"}, {"--out"}},
  };
  const std::pair<std::string, const char*> wrong[] = {
      {Path("no/such/folder"), "No such file or directory"},
      {Path(""), "it is a folder"},
      {old + "/new", "Not a directory"},
  };
  for (const auto& [command, flags] : commands) {
    for (const char* flag : flags) {
      for (const auto& [path, reason] : wrong) {
        if (flag != flags.front() && path != wrong[0].first) continue;
        std::vector<std::string> words = command;
        // An output that is good beside it stays as it is.
        if (flag != flags.front()) words.insert(words.end(), {flags.front(), old});
        words.insert(words.end(), {flag, path});
        const Outcome outcome = Arapctl(words);
        EXPECT_EQ(outcome.code, 2) << testing::PrintToString(words);
        EXPECT_THAT(outcome.err, HasSubstr(std::string(flag) + ": cannot write " + path))
            << testing::PrintToString(words);
        EXPECT_THAT(outcome.err, HasSubstr(reason));
      }
    }
  }
  const Outcome figures =
      Arapctl({"figures", "--server", "unix:/nobody", "--out", Path("no/folder")});
  EXPECT_EQ(figures.code, 2);
  EXPECT_EQ(Slurp(old), "before");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(Path("")), {}), 1);
}

}  // namespace
}  // namespace arap::cli
