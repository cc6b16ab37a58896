#include "core/files/shapes.h"

#include <vector>

#include "core/files/text_file.h"
#include "tests/support/folder.h"

namespace arap {
namespace {

class Shapes : public FolderTest {};

TEST_F(Shapes, RowsHaveTheShortestNumbersThatReadBackExactly) {
  ShapesFile file(Path("shapes.csv"), 2);
  file.Write(0, std::vector<Complex>{{0.1, -0.0}, {1e300, 1.0 / 3}});
  file.Write(7, std::vector<Complex>{{1, 2}, {NAN, -INFINITY}});
  const Status closed = file.Close();
  ASSERT_TRUE(closed) << closed.error().message;
  const Result<std::string> text = ReadTextFile(Path("shapes.csv"));
  ASSERT_TRUE(text) << text.error().message;
  EXPECT_EQ(*text, "frame,x0,y0,x1,y1\n0,0.1,-0,1e+300,0.3333333333333333\n7,1,2,nan,-inf\n");
}

TEST_F(Shapes, AFileThatCannotBeWrittenIsSaidAtTheEnd) {
  ShapesFile file(Path("nowhere/shapes.csv"), 1);
  file.Write(0, std::vector<Complex>{{1, 2}});
  const Status closed = file.Close();
  ASSERT_FALSE(closed);
  EXPECT_EQ(closed.error().kind, FaultKind::kInternal);
  EXPECT_EQ(closed.error().message, "cannot write " + Path("nowhere/shapes.csv"));
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

}  // namespace
}  // namespace arap
