// What arapctl says of itself: exit codes, help, suggestions, completion and man pages, without a
// server.
#include <cstdlib>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "client/cli/command_line.h"
#include "client/cli/exit_code.h"
#include "client/cli/help.h"
#include "client/cli/settings.h"
#include "client/cli/shell/completion.h"
#include "client/cli/shell/manual.h"
#include "client/cli/terminal.h"

namespace arap::cli {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

std::string ReadPage() {
  std::ifstream file(ARAP_ARAPCTL_PAGE);
  EXPECT_TRUE(file) << ARAP_ARAPCTL_PAGE;
  std::ostringstream text;
  text << file.rdbuf();
  return std::move(text).str();
}

// Every command of the tree with its help.
std::map<std::string, std::string> AllHelp(const CLI::App& command, const std::string& name) {
  std::map<std::string, std::string> all{
      {name, Help().make_help(&command, name, CLI::AppFormatMode::Normal)}};
  for (const CLI::App* inner : CommandsOf(command)) {
    all.merge(AllHelp(*inner, name + " " + inner->get_name()));
  }
  return all;
}

TEST(ExitCodes, OfEveryKindOfFault) {
  const struct {
    FaultKind kind;
    Exit exit;
  } cases[] = {
      {FaultKind::kDegenerateTriangle, Exit::kRefused},
      {FaultKind::kMeshTooLarge, Exit::kRefused},
      {FaultKind::kTooManyHandles, Exit::kRefused},
      {FaultKind::kAlreadyExists, Exit::kRefused},
      {FaultKind::kNotFound, Exit::kNotFound},
      {FaultKind::kUnknownHandle, Exit::kNotFound},
      {FaultKind::kUnauthenticated, Exit::kDenied},
      {FaultKind::kPermissionDenied, Exit::kDenied},
      {FaultKind::kDraining, Exit::kUnavailable},
      {FaultKind::kStoreUnavailable, Exit::kUnavailable},
      {FaultKind::kDeadlineExceeded, Exit::kUnavailable},
      {FaultKind::kOverloaded, Exit::kOverloaded},
      {FaultKind::kLimitExceeded, Exit::kOverloaded},
      {FaultKind::kOutOfMemory, Exit::kOverloaded},
      {FaultKind::kNumerical, Exit::kInternal},
      {FaultKind::kDataLoss, Exit::kInternal},
      {FaultKind::kInternal, Exit::kInternal},
      {FaultKind::kCancelled, Exit::kInterrupted},
  };
  for (const auto& [kind, exit] : cases) EXPECT_EQ(ExitOf(kind), exit) << FaultName(kind);
  for (const FaultInfo& info : FaultTable()) EXPECT_NE(ExitOf(info.kind), Exit::kOk) << info.reason;
}

TEST(ExitCodes, AreThoseOfThePageAndTheHelp) {
  const std::string page = ReadPage();
  cli::Run run;
  const auto app = MakeCommandLine("1", run);
  for (const ExitClass& one : ExitClasses()) {
    EXPECT_EQ(&InfoOf(one.exit), &one);
    EXPECT_THAT(page, HasSubstr(fmt::format("| {} | {} | {} |\n", static_cast<int>(one.exit),
                                            one.name, one.meaning)));
    EXPECT_THAT(app->get_footer(), HasSubstr(one.meaning));
  }
}

TEST(Settings, AreThoseOfThePage) {
  const std::string page = ReadPage();
  for (const Setting& setting : Settings()) {
    EXPECT_THAT(page, HasSubstr(fmt::format("`{}`", setting.key)));
  }
  EXPECT_EQ(VariableOf("tls-server-name"), "ARAPCTL_TLS_SERVER_NAME");
}

TEST(Suggestions, CountSlips) {
  EXPECT_EQ(Slips("", ""), 0u);
  EXPECT_EQ(Slips("", "abc"), 3u);
  EXPECT_EQ(Slips("sever", "server"), 1u);
  EXPECT_EQ(Slips("sevrer", "server"), 1u) << "neighbours that were swapped";
  EXPECT_EQ(Slips("BAKE", "bake"), 0u);
  EXPECT_EQ(Slips("drag", "load"), 3u);
}

TEST(Suggestions, AreNear) {
  const std::vector<std::string> names{"bake", "drag", "flatten", "mesh", "--server", "--seams"};
  EXPECT_THAT(Nearest("bale", names), ElementsAre("bake"));
  EXPECT_THAT(Nearest("flat", names), ElementsAre("flatten"));
  EXPECT_THAT(Nearest("--sever", names), ElementsAre("--server"));
  EXPECT_THAT(Nearest("fly", names), IsEmpty());
  EXPECT_EQ(DidYouMean("gard", {"card", "hard", "gird", "other"}),
            "; did you mean card, hard or gird?");
  EXPECT_EQ(DidYouMean("quite-else", names), "");
}

TEST(Wrapping, BreaksBetweenWordsAlone) {
  EXPECT_EQ(Wrapped("one two three", 8), "one two\nthree\n");
  EXPECT_EQ(Wrapped("one two three", 9, 2), "  one two\n  three\n");
  EXPECT_EQ(Wrapped("longer-than-that is", 6), "longer-than-that\nis\n");
  EXPECT_EQ(Wrapped("µµµ µµµ", 7), "µµµ µµµ\n") << "characters, not bytes";
  EXPECT_EQ(Wrapped("a\n\n  kept   as it is", 8), "a\n\n  kept   as it is\n");
  EXPECT_EQ(Wrapped("", 8), "");
}

TEST(HelpText, HasEightyColumnsAndExamples) {
  cli::Run run;
  const auto app = MakeCommandLine("1", run);
  for (const auto& [name, help] : AllHelp(*app, "arapctl")) {
    EXPECT_THAT(help, HasSubstr("Usage: " + name));
    std::istringstream lines(help);
    for (std::string line; std::getline(lines, line);) {
      EXPECT_LE(CharactersIn(line), kLineWidth) << name << ": " << line;
      EXPECT_FALSE(line.ends_with(' ')) << name << ": '" << line << "'";
    }
    // Of every command that does something there is an example.
    const bool is_leaf = help.find("\nCommands:") == std::string::npos;
    if (is_leaf) {
      EXPECT_THAT(help, HasSubstr("\n  arapctl " + name.substr(8))) << name;
    }
  }
}

// The commands that the table "JSON" of docs/arapctl.md has rows for: "mesh show", "every delete".
// A word without the command above it is of the one before it.
std::set<std::string> CommandsOfTheJsonTable() {
  const std::string page = ReadPage();
  std::istringstream lines(page.substr(page.find("\n## JSON\n")));
  std::set<std::string> commands;
  for (std::string line; std::getline(lines, line) && !line.starts_with("Any of them");) {
    if (!line.starts_with("| ")) continue;
    const std::string cell = line.substr(0, line.find('|', 1));
    std::string group = cell.starts_with("| every ") ? "every" : "";
    for (std::size_t at = 0; (at = cell.find('`', at)) != std::string::npos;) {
      const std::size_t end = cell.find('`', at + 1);
      std::string name = cell.substr(at + 1, end - at - 1);
      if (!group.empty() && name.find(' ') == std::string::npos) name = group + " " + name;
      group = name.substr(0, name.find(' '));
      commands.insert(name);
      at = end + 1;
    }
  }
  return commands;
}

void ExpectJson(const CLI::App& command, const std::string& name,
                const std::set<std::string>& documented) {
  const std::vector<const CLI::App*> inner = CommandsOf(command);
  for (const CLI::App* one : inner) {
    ExpectJson(*one, name.empty() ? one->get_name() : name + " " + one->get_name(), documented);
  }
  // What these print is for a shell, a pager and people.
  const bool is_text = name == "completion" || name == "man" || name == "help";
  if (!inner.empty() || is_text) return;
  EXPECT_NE(command.get_option_no_throw("--json"), nullptr) << name;
  const bool removes = name.ends_with(" delete") && documented.contains("every delete");
  EXPECT_TRUE(removes || documented.contains(name)) << name << " has no row in docs/arapctl.md";
}

TEST(Json, IsAnswerOfEveryCommandAndDocumented) {
  cli::Run run;
  ExpectJson(*MakeCommandLine("1", run), "", CommandsOfTheJsonTable());
}

// The command lines of the examples are right, but for files and servers that are not there.
TEST(HelpText, ExamplesAreParsed) {
  for (const Example& example : Examples()) {
    std::string text(example.lines);
    for (std::size_t at = 0; (at = text.find("\\\n")) != std::string::npos;) text.erase(at, 2);
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      line = line.substr(0, line.find("  #"));
      line = line.substr(line.find("arapctl "));
      line = line.substr(0, line.find_first_of(">|)"));
      if (line.starts_with("arapctl help")) continue;
      cli::Run run;
      const auto app = MakeCommandLine("1", run);
      EXPECT_NO_THROW(app->parse(line.substr(8))) << line;
      EXPECT_TRUE(run) << line;
      EXPECT_TRUE(line.starts_with(fmt::format("arapctl {}", example.command))) << line;
    }
  }
}

class Completion : public testing::Test {
 protected:
  std::vector<std::string> Words(const std::vector<std::string>& words) {
    std::vector<std::string> found;
    const Candidates candidates = Complete(*app_, words);
    files_ = candidates.files;
    for (const Candidate& one : candidates.words) found.push_back(one.word);
    return found;
  }

  cli::Run run_;
  const std::unique_ptr<CLI::App> app_ = MakeCommandLine("1", run_);
  bool files_ = false;
};

TEST_F(Completion, OfCommandsOptionsValuesAndFiles) {
  EXPECT_THAT(Words({"fl"}), ElementsAre("flatten"));
  EXPECT_FALSE(files_);
  EXPECT_THAT(Words({"token", ""}), ElementsAre("add", "list", "revoke"));
  EXPECT_THAT(Words({"help", "sample", "g"}), ElementsAre("garment", "grid"));
  EXPECT_THAT(Words({"bake", "--fra"}), ElementsAre("--frames-svg"));
  EXPECT_THAT(Words({"bake", "a.obj", "--h"}), ElementsAre("--help", "--hard"));
  EXPECT_THAT(Words({"drag", "--delivery", ""}), ElementsAre("every", "latest"));
  EXPECT_THAT(Words({"drag", "--delivery=l"}), ElementsAre("--delivery=latest"));
  EXPECT_THAT(Words({"drag", "--delivery", "=", "l"}), ElementsAre("latest")) << "as bash has it";
  EXPECT_THAT(Words({"completion", "z"}), ElementsAre("zsh"));
  EXPECT_FALSE(files_);
  EXPECT_THAT(Words({"bake", ""}), IsEmpty());
  EXPECT_TRUE(files_);
  EXPECT_THAT(Words({"bake", "--out", ""}), IsEmpty());
  EXPECT_TRUE(files_);
  EXPECT_THAT(Words({"bake", "--timeout", ""}), IsEmpty());
  EXPECT_FALSE(files_);
  EXPECT_THAT(Words({"nothing", "-"}), Contains("--version"));
  EXPECT_THAT(Words({}), IsEmpty());
}

TEST_F(Completion, HasALineForEach) {
  EXPECT_EQ(FormatCandidates({true, {{"a", "b"}, {"c", ""}}}), "files\na\tb\nc\t\n");
  for (const char* shell : {"bash", "zsh", "fish"}) {
    EXPECT_THAT(CompletionScript(shell), HasSubstr("arapctl __complete -- "));
  }
  EXPECT_EQ(CompletionScript("tcsh"), "");
}

TEST(ManPagesOf, EveryCommandAreThere) {
  cli::Run run;
  const auto app = MakeCommandLine("1.2.3", run);
  std::set<std::string> names;
  for (const ManPage& page : ManPages(*app, "1.2.3")) {
    names.insert(page.name);
    EXPECT_THAT(page.text, HasSubstr(".TH ARAPCTL"));
    EXPECT_THAT(page.text, HasSubstr("\n.SH SYNOPSIS\n"));
    for (const char c : page.text) EXPECT_GE(c, 0) << page.name << " has a letter beyond ASCII";
  }
  EXPECT_EQ(names.size(), AllHelp(*app, "arapctl").size());
  EXPECT_THAT(names, Contains("arapctl-token-add"));
  const std::string page = ManPageOf(*app, {}, "1.2.3").text;
  EXPECT_THAT(page, HasSubstr("ARAPCTL_TLS_CA"));
  EXPECT_THAT(page, HasSubstr(".SH EXIT STATUS"));
  EXPECT_EQ(page, ManPageOf(*app, {}, "1.2.3").text);
}

}  // namespace
}  // namespace arap::cli
