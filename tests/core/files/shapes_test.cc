#include <cmath>
#include <filesystem>
#include <vector>

#include "core/files/mesh_file.h"
#include "core/files/text_file.h"
#include "tests/support/folder.h"

namespace arap {
namespace {

class Shapes : public FolderTest {
 protected:
  std::size_t FileCount() const {
    std::size_t count = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(Path(""))) {
      ++count;
    }
    return count;
  }
};

TEST_F(Shapes, RowsHaveTheShortestNumbersThatReadBackExactly) {
  ShapesFile file(Path("shapes.csv"), 2);
  EXPECT_TRUE(file.Write(0, std::vector<Complex>{{0.1, -0.0}, {1e300, 1.0 / 3}}));
  EXPECT_TRUE(file.Write(7, std::vector<Complex>{{1, 2}, {NAN, -INFINITY}}));
  const Status closed = file.Close();
  ASSERT_TRUE(closed) << closed.error().message;
  const Result<std::string> text = ReadTextFile(Path("shapes.csv"));
  ASSERT_TRUE(text) << text.error().message;
  EXPECT_EQ(*text, "frame,x0,y0,x1,y1\n0,0.1,-0,1e+300,0.3333333333333333\n7,1,2,nan,-inf\n");
}

TEST_F(Shapes, AFileThatCannotBeWrittenIsSaidAtTheFirstRow) {
  ShapesFile file(Path("nowhere/shapes.csv"), 1);
  for (const Status& status : {file.Write(0, std::vector<Complex>{{1, 2}}), file.Close()}) {
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error(),
              Fault(FaultKind::kInternal,
                    "cannot write " + Path("nowhere/shapes.csv") + ": No such file or directory"));
  }
}

TEST_F(Shapes, WhatIsNotFinishedLeavesWhatWasThere) {
  Put("shapes.csv", "before");
  {
    ShapesFile file(Path("shapes.csv"), 1);
    EXPECT_TRUE(file.Write(0, std::vector<Complex>{{1, 2}}));
  }
  EXPECT_EQ(ReadTextFile(Path("shapes.csv")), "before");
  EXPECT_EQ(FileCount(), 1u);
}

class TextFile : public FolderTest {};

TEST_F(TextFile, IsReadAndWrittenByteByByte) {
  const std::string bytes("a\0\r\n\xff", 5);
  ASSERT_TRUE(WriteTextFile(Path("a"), bytes));
  EXPECT_EQ(ReadTextFile(Path("a")), bytes);
}

TEST_F(TextFile, FaultsNameThePathAndTheReason) {
  EXPECT_EQ(ReadTextFile(Path("missing")).error(),
            Fault(FaultKind::kNotFound, Path("missing") + ": No such file or directory"));
  const Status written = WriteTextFile(Path("nowhere/a"), "");
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error(), Fault(FaultKind::kInternal, "cannot write " + Path("nowhere/a") +
                                                             ": No such file or directory"));
  EXPECT_EQ(ReadTextFile(Path("")).error().kind, FaultKind::kNotFound);  // a folder
}

// A pipe, a device, somebody's link: they stay what they are.
TEST_F(TextFile, WhatIsNoRegularFileIsWrittenAsItGoes) {
  Put("a", "before");
  std::filesystem::create_symlink(Path("a"), Path("link"));
  ASSERT_TRUE(WriteTextFile(Path("link"), "after"));
  EXPECT_TRUE(std::filesystem::is_symlink(Path("link")));
  EXPECT_EQ(ReadTextFile(Path("a")), "after");
  EXPECT_TRUE(WriteTextFile("/dev/null", "gone"));
  const Status full = WriteTextFile("/dev/full", "no room");
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().message, "cannot write /dev/full: No space left on device");
}

TEST_F(TextFile, TheNewFileHasTheModeOfTheOld) {
  using std::filesystem::perms;
  constexpr perms kPrivate = perms::owner_read | perms::owner_write;
  std::filesystem::permissions(Put("a", "before"), kPrivate);
  ASSERT_TRUE(WriteTextFile(Path("a"), "after"));
  EXPECT_EQ(std::filesystem::status(Path("a")).permissions(), kPrivate);
}

}  // namespace
}  // namespace arap
