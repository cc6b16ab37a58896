// arapctl session, mesh and handles: what one run makes another finds.
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "server/host/host.h"
#include "tests/cli/run.h"

namespace arap::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

class SessionCommand : public FolderTest {
 protected:
  void SetUp() override {
    host::HostOptions options;
    options.listen = {address_};
    options.store.store = "memory";
    auto host = host::Host::Start(options);
    ASSERT_TRUE(host) << host.error().message;
    host_ = *std::move(host);
    ASSERT_EQ(Arapctl({"sample", "grid", "--size", "5", "--out", Path("grid.obj"), "--track",
                       Path("grid.json")})
                  .code,
              0);
  }

  Outcome Run(std::vector<std::string> words) const {
    words.insert(words.end(), {"--server", address_});
    return Arapctl(words);
  }
  std::string Text(const std::vector<std::string>& words) const {
    const Outcome outcome = Run(words);
    EXPECT_EQ(outcome.code, 0) << testing::PrintToString(words) << outcome.err;
    return outcome.out;
  }
  nlohmann::json Json(std::vector<std::string> words) const {
    words.emplace_back("--json");
    return nlohmann::json::parse(Run(words).out, nullptr, false);
  }

  const std::string address_ = "unix:" + Path("arapd.sock");
  std::unique_ptr<host::Host> host_;
};

TEST_F(SessionCommand, SessionsAreMadeListedShownAndDeleted) {
  EXPECT_EQ(Text({"session", "list"}), "");
  EXPECT_THAT(Text({"session", "create", "work", "--ttl", "60", "--label", "user=ann"}),
              HasSubstr("labels   user=ann\n"));
  const auto list = Json({"session", "list"});
  ASSERT_EQ(list["sessions"].size(), 1u);
  EXPECT_EQ(list["sessions"][0]["id"], "work");
  EXPECT_EQ(list["sessions"][0]["ttl_seconds"], 60);
  EXPECT_EQ(list["sessions"][0]["labels"]["user"], "ann");
  EXPECT_THAT(Text({"session", "list"}), HasSubstr("work "));
  EXPECT_EQ(Text({"session", "delete", "work"}), "deleted work\n");
  EXPECT_EQ(Run({"session", "show", "work"}).code, 4);
  EXPECT_EQ(Json({"session", "show", "work"})["error"]["reason"], "NOT_FOUND");
}

TEST_F(SessionCommand, MeshesAndHandlesStayBetweenRuns) {
  Text({"session", "create", "work"});
  const auto mesh = Json({"mesh", "register", "work/grid", Path("grid.obj")});
  EXPECT_EQ(mesh["id"], "grid");
  EXPECT_EQ(mesh["vertices"], 25);
  EXPECT_EQ(Json({"mesh", "list", "work"})["meshes"][0]["id"], "grid");
  EXPECT_THAT(Text({"mesh", "show", "work/grid"}), HasSubstr("triangles   32\n"));
  EXPECT_EQ(Json({"mesh", "register", "work", Path("grid.obj")})["shared"], true)
      << "a name made of its content, and factors that are there";

  const auto set = Json({"handles", "compile", "work/set", "grid", Path("grid.json")});
  const std::size_t count = set["handles"].size();
  ASSERT_GE(count, 2u);
  const std::string first = set["handles"][0]["name"];
  EXPECT_THAT(Text({"handles", "list", "work"}), HasSubstr("set  "));
  const std::string add = Put("add.json", R"({"handles": [{"name": "new", "rest": [2, 2]}],
                                              "frames": []})");
  const auto edited = Json({"handles", "edit", "work/set", "--remove", first, "--add", add});
  EXPECT_EQ(edited["handles"].size(), count);
  EXPECT_EQ(edited["handles"].back()["name"], "new");
  EXPECT_GT(edited["revision"], set["revision"]);
  const std::string shown = Text({"handles", "show", "work/set"});
  EXPECT_THAT(shown, HasSubstr("new "));
  EXPECT_THAT(shown, Not(HasSubstr("\n" + first + " ")));

  // At rest a point is where it is.
  const auto picks =
      Json({"handles", "pick", "work/set", "--pick", "1.25,1.5", "--pick", "-9,2"})["picks"];
  ASSERT_EQ(picks.size(), 2u);
  EXPECT_NEAR(picks[0]["rest"][0], 1.25, 1e-6);
  EXPECT_NEAR(picks[0]["rest"][1], 1.5, 1e-6);
  EXPECT_EQ(picks[1]["hit"], false);
  EXPECT_EQ(Run({"handles", "pick", "work/set", "--pick", "1,1", "--target", "nobody=1,1"}).code,
            4);

  EXPECT_EQ(Text({"handles", "delete", "work/set"}), "deleted work/set\n");
  EXPECT_EQ(Text({"mesh", "delete", "work/grid"}), "deleted work/grid\n");
  EXPECT_EQ(Run({"mesh", "show", "work/grid"}).code, 4);
}

TEST_F(SessionCommand, WrongNamesAreWrongCommandLines) {
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"session"},
           {"session", "create", "a/b"},
           {"session", "create", "a", "--label", "no-value"},
           {"mesh", "show", "work"},
           {"mesh", "show", "work/a/b"},
           {"mesh", "list", "work/grid"},
           {"handles", "edit", "work/set"},
           {"handles", "pick", "work/set"},
           {"handles", "pick", "work/set", "--pick", "1"},
           {"handles", "pick", "work/set", "--pick", "1,1", "--target", "1,1"}}) {
    EXPECT_EQ(Run(words).code, 2) << testing::PrintToString(words);
  }
}

}  // namespace
}  // namespace arap::cli
