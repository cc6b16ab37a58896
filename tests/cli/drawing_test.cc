// What arapctl draws by itself and what the server answers are the same bytes.
#include <array>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "core/files/mesh_file.h"
#include "tests/cli/run.h"
#include "tests/cli/server_test.h"

namespace arap::cli {
namespace {

using client::DrawingFormat;
using client::DrawingOptions;
using testing::HasSubstr;

// A bumpy sheet of two groups and a flat one of another object, with a vertex row in common that a
// seam runs along.
constexpr int kSide = 12;

std::string TwoObjects() {
  std::string text = "o shirt\n";
  const auto vertices = [&](double x, double bump) {
    for (int row = 0; row <= kSide; ++row) {
      for (int column = 0; column <= kSide; ++column) {
        text += "v " + std::to_string(x + column) + " " + std::to_string(row) + " " +
                std::to_string(bump * column * row * (kSide - row)) + "\n";
      }
    }
  };
  vertices(0, 0.01);
  vertices(20, 0);
  const auto faces = [&](int first) {
    for (int row = 0; row < kSide; ++row) {
      for (int column = 0; column < kSide; ++column) {
        const int a = first + row * (kSide + 1) + column, b = a + kSide + 1;
        for (const auto& [p, q, r] : {std::array{a, a + 1, b + 1}, std::array{a, b + 1, b}}) {
          text +=
              "f " + std::to_string(p) + " " + std::to_string(q) + " " + std::to_string(r) + "\n";
        }
      }
    }
  };
  faces(1);
  text += "o Ärmel & <Co>\n";
  faces(1 + (kSide + 1) * (kSide + 1));
  return text;
}

struct Sample {
  const char* what;
  std::vector<std::string> flags;
  std::vector<DrawingOptions> options;  // an SVG, a DXF and a PDF each
};

std::vector<Sample> Samples() {
  const auto each = [](const DrawingOptions& options) {
    std::vector<DrawingOptions> all(3, options);
    all[1].format = DrawingFormat::kDxf;
    all[1].paper.clear();
    all[1].interior = false;
    all[2].format = DrawingFormat::kPdf;
    return all;
  };
  std::vector<Sample> samples{{"plain", {"--unit", "cm", "--plain"}, {}},
                              {"coloured", {"--unit", "in", "--interior"}, {}},
                              {"allowance",
                               {"--unit", "cm", "--allowance", "7.5", "--corners", "round",
                                "--notches", "--sheet-width", "200"},
                               {}},
                              {"pages",
                               {"--unit", "cm", "--allowance", "4", "--corners", "square",
                                "--paper", "A5", "--overlap", "15", "--margin", "5"},
                               {}}};
  DrawingOptions plain, coloured, allowance, pages;
  plain.millimetres_per_unit = allowance.millimetres_per_unit = pages.millimetres_per_unit = 10;
  plain.plain = true;
  coloured.millimetres_per_unit = 25.4;
  coloured.interior = true;
  allowance.allowance = 7.5;
  allowance.corners = Corners::kRound;
  allowance.notches = true;
  allowance.sheet_width = 200;
  pages.allowance = 4;
  pages.corners = Corners::kSquare;
  pages.paper = "A5";
  pages.overlap = 15;
  pages.margin = 5;
  samples[0].options = each(plain);
  samples[1].options = each(coloured);
  samples[2].options = each(allowance);
  samples[3].options = each(pages);
  return samples;
}

class DrawingsOnTheWire : public ServerTest {
 protected:
  // For its files.
  class Folder : public FolderTest {
   public:
    using FolderTest::Path;
    using FolderTest::Put;
    void TestBody() override {}
  };
  Folder folder_;
};

TEST_F(DrawingsOnTheWire, AreThoseOfArapctl) {
  folder_.Put("a.obj", TwoObjects());
  std::string seam;
  for (int column = 1; column <= kSide + 1; ++column) {
    seam += std::to_string(6 * (kSide + 1) + column) + " ";
  }
  folder_.Put("seam.txt", seam + "\n");
  const auto mesh = ReadSurfaceMesh(folder_.Path("a.obj"));
  ASSERT_TRUE(mesh) << mesh.error().message;
  client::FlattenQuery query;
  for (std::uint32_t column = 0; column < kSide; ++column) {
    query.options.cut.seams.push_back({6 * (kSide + 1) + column, 6 * (kSide + 1) + column + 1});
  }
  query.options.grain_lines = {{0, 2, 45 * (std::numbers::pi / 180)}};
  query.parts = {{0, "shirt"}, {2 * kSide * kSide, "Ärmel & <Co>"}};
  for (const Sample& sample : Samples()) {
    query.drawings = sample.options;
    const auto answer = client().Flatten(*mesh, query);
    ASSERT_TRUE(answer) << sample.what << answer.error().message;
    std::vector<std::string> words{"flatten",
                                   folder_.Path("a.obj"),
                                   "--spawn",
                                   "--seams",
                                   folder_.Path("seam.txt"),
                                   "--grain",
                                   "1,3,45",
                                   "--svg",
                                   folder_.Path("a.svg"),
                                   "--dxf",
                                   folder_.Path("a.dxf"),
                                   "--pdf",
                                   folder_.Path("a.pdf")};
    words.insert(words.end(), sample.flags.begin(), sample.flags.end());
    const Outcome outcome = Arapctl(words);
    ASSERT_EQ(outcome.code, 0) << sample.what << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("piece 2 (shirt 2): "));
    EXPECT_THAT(outcome.out, HasSubstr("piece 3 (Ärmel & <Co>): "));
    for (const auto& [drawing, ending] :
         {std::pair(0, ".svg"), std::pair(1, ".dxf"), std::pair(2, ".pdf")}) {
      for (const DrawingFile& file : answer->drawings[static_cast<std::size_t>(drawing)].files) {
        const std::string page = file.page.empty() ? "" : "-" + file.page;
        EXPECT_TRUE(Slurp(folder_.Path("a" + page + ending)) == file.bytes)
            << sample.what << ending << page;
      }
    }
  }
}

}  // namespace
}  // namespace arap::cli
