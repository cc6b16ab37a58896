// The real arapctl: what it takes from the environment and the config file, what it says of mistyped
// words, and its scripts and man pages as the programs read them that they are for.
#include <cstdlib>
#include <filesystem>
#include <map>
#include <utility>

#include <gmock/gmock.h>

#include "tests/cli/run.h"

namespace arap::cli {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

// Sets variables for as long as it is there.
class Environment {
 public:
  explicit Environment(const std::map<std::string, std::string>& values) : values_(values) {
    for (const auto& [name, value] : values_) setenv(name.c_str(), value.c_str(), 1);
  }
  ~Environment() {
    for (const auto& [name, value] : values_) unsetenv(name.c_str());
  }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  std::map<std::string, std::string> values_;
};

class SettingsOfCommand : public FolderTest {
 protected:
  // The first call frees the environment of what is not the test's.
  void SetUp() override { ASSERT_EQ(Arapctl({"--version"}).code, 0); }

  // What "cannot be reached" names is the server that was meant.
  std::string Reached(const std::vector<std::string>& words) const {
    const Outcome outcome = Arapctl(words);
    EXPECT_EQ(outcome.code, 6) << outcome.err;
    return outcome.err;
  }
};

TEST_F(SettingsOfCommand, FlagBeforeEnvironmentBeforeFile) {
  const std::string flag = "unix:" + Path("flag"), variable = "unix:" + Path("variable");
  const std::string config =
      Put("config", "# where\nserver = \"unix:" + Path("stored") + "\"\n\ntimeout = 5\n");
  EXPECT_EQ(Arapctl({"info"}).code, 2);
  const Environment named({{"ARAPCTL_CONFIG", config}});
  EXPECT_THAT(Reached({"info"}), HasSubstr("Cannot reach unix:" + Path("stored")));
  const Environment server({{"ARAPCTL_SERVER", variable}});
  EXPECT_THAT(Reached({"info"}), HasSubstr("Cannot reach " + variable));
  EXPECT_THAT(Reached({"info", "--server", flag}), HasSubstr("Cannot reach " + flag));
  EXPECT_THAT(Reached({"info", "--server=" + flag}), HasSubstr("Cannot reach " + flag));
  EXPECT_EQ(Arapctl({"info", "--spawn"}).code, 0) << "a private one needs none of this";
}

TEST_F(SettingsOfCommand, TheFileIsInTheFoldersOfTheUser) {
  std::filesystem::create_directories(Path("home/.config/arapctl"));
  std::filesystem::create_directories(Path("xdg/arapctl"));
  Put("home/.config/arapctl/config", "server = unix:" + Path("home.sock") + "\n");
  const char* const home = std::getenv("HOME");
  const std::string old_home = home == nullptr ? "" : home;
  {
    const Environment at_home({{"HOME", Path("home")}});
    EXPECT_THAT(Reached({"info"}), HasSubstr("home.sock"));
    Put("xdg/arapctl/config", "server = unix:" + Path("xdg.sock") + "\n");
    const Environment xdg({{"XDG_CONFIG_HOME", Path("xdg")}});
    EXPECT_THAT(Reached({"info"}), HasSubstr("xdg.sock"));
  }
  if (home != nullptr) setenv("HOME", old_home.c_str(), 1);
}

TEST_F(SettingsOfCommand, AnIdentityOfTheFileIsForItsServerAlone) {
  const std::string own = "unix:" + Path("own"), other = "unix:" + Path("other");
  const Environment named({{"ARAPCTL_CONFIG", Put("config", "server = " + own + "\ntoken-file = " +
                                                                Path("none") + "\n")}});
  const Outcome mine = Arapctl({"info"});
  EXPECT_EQ(mine.code, 4) << "the token is looked for";
  EXPECT_THAT(mine.err, HasSubstr(Path("none")));
  EXPECT_EQ(Arapctl({"info", "--server", own}).code, 4);
  EXPECT_THAT(Reached({"info", "--server", other}), Not(HasSubstr(Path("none"))));
  const Environment variable({{"ARAPCTL_TOKEN_FILE", Path("mine")}});
  EXPECT_THAT(Arapctl({"info", "--server", other}).err, HasSubstr(Path("mine")));
}

TEST_F(SettingsOfCommand, WhatIsWrongIsTold) {
  const std::pair<const char*, const char*> files[] = {
      {"sever = a:1\n", "unknown key 'sever'; did you mean server?"},
      {"token = secret\n", "unknown key 'token'"},
      {"server = a:1\nserver = b:1\n", "key 'server' is there twice"},
      {"[work]\nserver = a:1\n", "section [work]"},
      {"server =\n", "key 'server' has no value"},
      {"timeout = soon\n", "(--timeout=soon is of the environment or of "},
  };
  for (const auto& [text, message] : files) {
    const std::string path = Put("config", text);
    const Environment named({{"ARAPCTL_CONFIG", path}});
    const Outcome outcome = Arapctl({"bake", "a.obj", "b.json", "--out", Path("c.csv"), "--spawn"});
    EXPECT_EQ(outcome.code, 2) << text;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr(message), HasSubstr(path))) << text;
    EXPECT_THAT(outcome.err, Not(HasSubstr("secret")));
  }
  const Environment none({{"ARAPCTL_CONFIG", Path("none")}});
  EXPECT_THAT(Arapctl({"info", "--spawn"}).err, HasSubstr(Path("none")));
  EXPECT_EQ(Arapctl({"token", "list", "--file", Put("t.json", "[]")}).code, 0)
      << "what asks no server needs no settings";
}

TEST_F(SettingsOfCommand, MistypedWordsAreGuessed) {
  const std::pair<std::vector<std::string>, const char*> cases[] = {
      {{"flaten"}, "there is no command 'flaten'; did you mean flatten?"},
      {{"token", "ad"}, "there is no command 'ad'; did you mean add?"},
      {{"help", "bkae"}, "there is no command 'bkae'; did you mean bake?"},
      {{"info", "--sever", "a:1"}, "there is no option --sever; did you mean --server?"},
      {{"info", "--spwan"}, "did you mean --spawn?"},
      {{"flatten", "a.obj", "--alowance=3"}, "did you mean --allowance?"},
  };
  for (const auto& [words, message] : cases) {
    const Outcome outcome = Arapctl(words);
    EXPECT_EQ(outcome.code, 2) << testing::PrintToString(words);
    EXPECT_THAT(outcome.err, HasSubstr(message));
    EXPECT_THAT(outcome.err, HasSubstr("`arapctl help"));
  }
  EXPECT_THAT(Arapctl({"quux"}).err, Not(HasSubstr("did you mean")));
}

TEST_F(SettingsOfCommand, HelpIsTheHelpOfTheCommand) {
  EXPECT_EQ(Arapctl({"help"}).out, Arapctl({"--help"}).out);
  EXPECT_EQ(Arapctl({"help", "token", "add"}).out, Arapctl({"token", "add", "--help"}).out);
  const Outcome help = Arapctl({"help", "bake"});
  EXPECT_EQ(help.code, 0);
  EXPECT_THAT(help.out,
              AllOf(HasSubstr("Usage: arapctl bake [OPTIONS] MESH TRACK"),
                    HasSubstr("\nExamples:\n  arapctl bake bear.obj"), Not(HasSubstr("\033"))));
}

// Whether a program is there.
bool IsThere(const std::string& program) {
  return std::system(("command -v " + program + " >/dev/null 2>&1").c_str()) == 0;  // NOLINT
}

int Shell(const std::string& command) {
  const int status = std::system(command.c_str());  // NOLINT(concurrency-mt-unsafe)
  return status;
}

TEST_F(SettingsOfCommand, CompletionIsReadByTheShells) {
  for (const char* shell : {"bash", "zsh", "fish"}) {
    const Outcome outcome = Arapctl({"completion", shell});
    EXPECT_EQ(outcome.code, 0);
    Put(shell, outcome.out);
    if (IsThere(shell)) {
      EXPECT_EQ(Shell(std::string(shell) + " -n " + Path(shell)), 0) << shell;
    }
  }
  EXPECT_EQ(Arapctl({"completion", "tcsh"}).code, 2);
  // As a shell calls it.
  Put("try.sh",
      "PATH=\"$1:$PATH\"; cd \"$2\"; . ./bash\n"
      "COMP_WORDS=(arapctl flatten --method = a); COMP_CWORD=4; _arapctl; echo "
      "\"${COMPREPLY[*]}\"\n"
      "COMP_WORDS=(arapctl to); COMP_CWORD=1; _arapctl; echo \"${COMPREPLY[*]}\"\n"
      "COMP_WORDS=(arapctl bake ba); COMP_CWORD=2; _arapctl; echo \"${COMPREPLY[*]}\"\n");
  const std::string bin = std::filesystem::path(ARAPCTL_PATH).parent_path().string();
  ASSERT_EQ(Shell("bash " + Path("try.sh") + " " + bin + " " + Path("") + " > " + Path("out")), 0);
  EXPECT_EQ(Slurp(Path("out")), "abf arap-edge arap-face\ntoken\nbash\n");
}

TEST_F(SettingsOfCommand, ManPagesAreReadWithoutAWarning) {
  ASSERT_EQ(Arapctl({"man", "--out", Path("man/man1")}).code, 0);
  EXPECT_EQ(Arapctl({"man", "token", "add"}).out, Slurp(Path("man/man1/arapctl-token-add.1")));
  EXPECT_EQ(Arapctl({"man", "fly"}).code, 4);
  if (!IsThere("man")) GTEST_SKIP() << "no man";
  for (const auto& page : std::filesystem::directory_iterator(Path("man/man1"))) {
    const std::string out = Path("formatted");
    EXPECT_EQ(Shell("LC_ALL=C.UTF-8 MANWIDTH=80 man --warnings -l " + page.path().string() + " > " +
                    out + " 2>&1"),
              0);
    EXPECT_THAT(Slurp(out), AllOf(HasSubstr("SYNOPSIS"), Not(HasSubstr("warning")))) << page.path();
  }
}

}  // namespace
}  // namespace arap::cli
