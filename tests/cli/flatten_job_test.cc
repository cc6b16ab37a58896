// flatten --job: asking again finds the job, also on a server that was started anew.
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "server/host/host.h"
#include "tests/cli/run.h"

namespace arap::cli {
namespace {

using testing::HasSubstr;

constexpr const char* kSheet =
    "v 0 0 0\nv 1 0 0.2\nv 2 0 0\nv 0 1 0\nv 1 1 0.3\nv 2 1 0\n"
    "f 1 2 5\nf 1 5 4\nf 2 3 6\nf 2 6 5\n";
constexpr const char* kTetrahedron =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

// A server on a socket that keeps what it has in the test's folder.
class FlattenJobCommand : public FolderTest {
 protected:
  FlattenJobCommand() { Start(); }

  // In the place of the one before.
  void Start() {
    host_ = nullptr;
    host::HostOptions options;
    options.listen = {address_};
    options.store.store = "sqlite:" + Path("state");
    auto host = host::Host::Start(options);
    ASSERT_TRUE(host) << host.error().message;
    host_ = *std::move(host);
  }

  Outcome Flatten(const std::string& surface, const std::string& job, const std::string& out) {
    return Arapctl({"flatten", surface, "--server", address_, "--job", job, "--out", Path(out)});
  }

  const std::string address_ = "unix:" + Path("arapd.sock");
  const std::string sheet_ = Put("sheet.obj", kSheet);
  const std::string tetrahedron_ = Put("tetrahedron.obj", kTetrahedron);

 private:
  std::unique_ptr<host::Host> host_;
};

TEST_F(FlattenJobCommand, AskingAgainFindsTheJob) {
  const Outcome first = Flatten(sheet_, "work/sheet", "first.obj");
  ASSERT_EQ(first.code, 0) << first.err;
  EXPECT_THAT(Slurp(Path("first.obj")), HasSubstr("vt "));
  Start();
  const Outcome again = Flatten(sheet_, "work/sheet", "again.obj");
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(Slurp(Path("again.obj")), Slurp(Path("first.obj")));
  EXPECT_EQ(again.out, first.out);
  const Outcome other = Flatten(tetrahedron_, "work/sheet", "other.obj");
  EXPECT_EQ(other.code, 3) << "the name is that of another surface";
  EXPECT_THAT(other.err, HasSubstr("ALREADY_EXISTS"));
}

TEST_F(FlattenJobCommand, FailuresAreToldAgain) {
  for (int time = 0; time < 2; ++time) {
    const Outcome failed = Flatten(tetrahedron_, "work/ball", "ball.obj");
    EXPECT_EQ(failed.code, 3);
    EXPECT_THAT(failed.err, HasSubstr("NOT_A_DISK"));
    Start();
  }
}

TEST_F(FlattenJobCommand, WrongNamesAreWrongCommandLines) {
  for (const char* name : {"sheet", "/sheet", "work/", "work/a/b", "two words/sheet"}) {
    const Outcome wrong = Flatten(sheet_, name, "wrong.obj");
    EXPECT_EQ(wrong.code, 2) << name;
    EXPECT_THAT(wrong.err, HasSubstr("SESSION/JOB")) << name;
  }
}

}  // namespace
}  // namespace arap::cli
