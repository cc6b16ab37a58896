// Files that other programs wrote, laid flat and written back, against a private server.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "core/files/text_file.h"
#include "tests/cli/run.h"

namespace arap::cli {
namespace {

using testing::HasSubstr;

constexpr int kColumns = 6, kRows = 3;  // of quads
constexpr double kRadius = 20, kStep = 10;

// The length of the tube around, along its chords.
double Width() { return kColumns * 2 * kRadius * std::sin(std::numbers::pi / (4 * kColumns)); }

// The corners of a quad, from 1.
std::array<int, 4> QuadAt(int row, int column) {
  const int a = row * (kColumns + 1) + column + 1;
  return {a, a + 1, a + kColumns + 2, a + kColumns + 1};
}

// The vertices with colours, texture coordinates and normals of a quarter of a tube, kRows of kStep
// high.
std::string TubeHead() {
  std::string text = "# tube\nmtllib tube.mtl\no Tube\n";
  std::string normals;
  for (int row = 0; row <= kRows; ++row) {
    for (int column = 0; column <= kColumns; ++column) {
      const double angle = std::numbers::pi * column / (2 * kColumns);
      text += fmt::format("v {} {} {} 0.2 0.4 0.6\n", kRadius * std::cos(angle),
                          kRadius * std::sin(angle), kStep * row);
      normals += fmt::format("vn {:.4f} {:.4f} 0\n", std::cos(angle), std::sin(angle));
    }
  }
  return text + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n" + normals + "s 1\n";
}

// It with quads, as modelling programs write them.
std::string Tube() {
  std::string text = TubeHead();
  for (int row = 0; row < kRows; ++row) {
    text += fmt::format("g row_{}\nusemtl wool  # {}\n", row, row);
    for (int column = 0; column < kColumns; ++column) {
      const auto [a, b, c, d] = QuadAt(row, column);
      text += fmt::format("f {0}/1/{0} {1}/2/{1} {2}/3/{2} {3}/4/{3}\n", a, b, c, d);
    }
  }
  return text;
}

// It with faces of every form, and all that may stand between them.
std::string TubeOfEverything(const std::string& end) {
  constexpr int kVertices = (kColumns + 1) * (kRows + 1);
  constexpr const char* kForms[] = {
      "f {0}/1/{0} {1}/2/{1} {2}/3/{2} {3}/4/{3}\n",
      "f {0} {1} {2}\n# f 1 2 3\n\nf {0} {2} {3} # half\n",
      "g one two\nf {0}//{0} {1}//{1} {2}//{2} {3}//{3}\nusemtl a b.mtl  # vt 1 2\n",
      "f {4}/-1/{4} {5}/-2/{5} {6}/-3/{6} {7}/-4/{7}  \n",
      "  f {0}/1 {1}/2 \\\n\t{2}/3 \\\n{3}/4\ns off\n",
      "f\t{0} {1}\t{2} {3} # 1/2\no C:\\parts\\\nl 1 2 3\np 1\nvn 0 0 1\n",
  };
  std::string text = TubeHead() + "hair 7 \\\n8\n";
  std::size_t number = 0;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const auto [a, b, c, d] = QuadAt(row, column);
      text +=
          fmt::format(fmt::runtime(kForms[number++ % std::size(kForms)]), a, b, c, d,
                      a - kVertices - 1, b - kVertices - 1, c - kVertices - 1, d - kVertices - 1);
    }
  }
  text += "# end";
  std::string ended;
  for (const char c : text) c == '\n' ? ended += end : ended += c;
  return ended;
}

// A face with "7", "7/3" and "7/3/2" as "7//", "7//" and "7//2".
std::string CornersWithoutLayout(const std::string& face) {
  constexpr const char* kCorner = "-0123456789/";
  std::string rest;
  for (std::size_t at = 0; at < face.size();) {
    const std::size_t end = std::min(face.find_first_not_of(kCorner, at), face.size());
    if (end == at) {
      rest += face[at++];
      continue;
    }
    const std::string corner = face.substr(at, end - at);
    const std::size_t first = std::min(corner.find('/'), corner.size());
    const std::size_t second = std::min(corner.find('/', first + 1), corner.size() - 1);
    rest += corner.substr(0, first) + "//" + (first < second ? corner.substr(second + 1) : "");
    at = end;
  }
  return rest;
}

// The text without texture coordinates: no lines of them, and corners without their index. All else
// is as it was, byte by byte. For LF and CRLF.
std::string WithoutLayout(const std::string& text) {
  std::string rest;
  bool face = false, joined = false;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size() - 1) + 1;
    const std::string line = text.substr(at, end - at);
    at = end;
    if (line.starts_with("vt ")) continue;
    const std::size_t first = line.find_first_not_of(" \t");
    if (!joined) face = first != std::string::npos && line[first] == 'f';
    joined = line.ends_with("\\\n") || line.ends_with("\\\r\n");
    if (!face) {
      rest += line;
      continue;
    }
    const std::size_t comment = std::min(line.find('#'), line.size());
    rest += CornersWithoutLayout(line.substr(0, comment)) + line.substr(comment);
  }
  return rest;
}

struct Layout {
  std::vector<std::string> others;  // lines without vt, and corners without their middle index
  std::vector<std::array<double, 2>> uv;
};

Layout Split(const std::string& text) {
  Layout layout;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string word, other;
    words >> word;
    if (word == "vt") {
      std::array<double, 2>& uv = layout.uv.emplace_back();
      words >> uv[0] >> uv[1];
      continue;
    }
    if (word == "f") {
      other = word;
      while (words >> word) {
        const std::size_t last = std::min(word.rfind('/'), word.size());
        other += ' ' + word.substr(0, word.find('/')) + word.substr(last);
      }
    }
    layout.others.push_back(other.empty() ? line : other);
  }
  return layout;
}

// The sides of the box around the layout, the smaller one first.
std::array<double, 2> SidesOf(const Layout& layout) {
  std::array<double, 2> sides{};
  for (std::size_t k = 0; k < 2; ++k) {
    const auto [low, high] =
        std::minmax_element(layout.uv.begin(), layout.uv.end(),
                            [k](const auto& a, const auto& b) { return a[k] < b[k]; });
    sides[k] = (*high)[k] - (*low)[k];
  }
  std::sort(sides.begin(), sides.end());
  return sides;
}

class FlattenFiles : public FolderTest {
 protected:
  Outcome Flatten(const std::string& name, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"flatten", Path(name), "--spawn", "--out", Path("flat.obj")};
    words.insert(words.end(), more.begin(), more.end());
    return Arapctl(words);
  }
};

TEST_F(FlattenFiles, KeepsAllOfTheFileButTextureCoordinates) {
  Put("tube.obj", Tube());
  const Outcome outcome = Flatten("tube.obj");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const Layout before = Split(Tube()), after = Split(Slurp(Path("flat.obj")));
  EXPECT_EQ(after.others, before.others);
  ASSERT_EQ(after.uv.size(), static_cast<std::size_t>((kColumns + 1) * (kRows + 1)));
  EXPECT_NEAR(SidesOf(after)[0], kRows * kStep, 1e-6);
  EXPECT_NEAR(SidesOf(after)[1], Width(), 1e-6);

  // The same at the size of a texture.
  ASSERT_EQ(Flatten("tube.obj", {"--vt", "unit"}).code, 0);
  const Layout unit = Split(Slurp(Path("flat.obj")));
  EXPECT_EQ(unit.others, before.others);
  EXPECT_NEAR(SidesOf(unit)[0], kRows * kStep / Width(), 1e-6);
  EXPECT_EQ(SidesOf(unit)[1], 1);
  for (const auto& [u, v] : unit.uv) {
    EXPECT_TRUE(u >= 0 && u <= 1 && v >= 0 && v <= 1) << u << " " << v;
  }
}

TEST_F(FlattenFiles, TheRoundTripChangesTextureCoordinatesAlone) {
  for (const char* end : {"\n", "\r\n"}) {
    for (const char* mark : {"", "\xef\xbb\xbf"}) {
      const std::string before = mark + TubeOfEverything(end);
      Put("tube.obj", before);
      const Outcome outcome = Flatten("tube.obj");
      ASSERT_EQ(outcome.code, 0) << outcome.err;
      EXPECT_THAT(outcome.err, HasSubstr("unknown_statements"));
      const std::string after = ReadBytes(Path("flat.obj")).value();  // with its mark
      EXPECT_EQ(WithoutLayout(after), WithoutLayout(before));
      const Layout layout = Split(after);
      ASSERT_EQ(layout.uv.size(), static_cast<std::size_t>((kColumns + 1) * (kRows + 1)));
      EXPECT_NEAR(SidesOf(layout)[0], kRows * kStep, 1e-6);
      EXPECT_NEAR(SidesOf(layout)[1], Width(), 1e-6);
      // Once more, and nothing changes.
      Put("tube.obj", after);
      ASSERT_EQ(Flatten("tube.obj").code, 0);
      EXPECT_EQ(ReadBytes(Path("flat.obj")).value(), after);
    }
  }
}

// One surface, whatever wrote it: the answers are the same byte by byte.
TEST_F(FlattenFiles, TheSameSurfaceHasTheSameAnswer) {
  std::string off = fmt::format("OFF{} {}\n", (kColumns + 1) * (kRows + 1), kColumns * kRows);
  std::istringstream lines(TubeHead());
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("v ")) off += line.substr(2) + "\r";
  }
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const auto [a, b, c, d] = QuadAt(row, column);
      off += fmt::format("4\t{} {} {} {} 0.5 1 0 # quad\r", a - 1, b - 1, c - 1, d - 1);
    }
  }
  std::string expected;
  for (const auto& [name, text] : {std::pair("a.obj", Tube()),
                                   {"b.obj", TubeOfEverything("\n")},
                                   {"c.obj", TubeOfEverything("\r\n")},
                                   {"d.off", off}}) {
    Put(name, text);
    const Outcome outcome = Flatten(name, {"--report", Path("r.json"), "--sigma"});
    ASSERT_EQ(outcome.code, 0) << name << outcome.err;
    const auto report = nlohmann::json::parse(Slurp(Path("r.json")));
    std::string answer = report["distortion"].dump() + report["singular_values"].dump();
    std::istringstream flat(Slurp(Path("flat.obj")));
    for (std::string line; std::getline(flat, line);) {
      if (line.ends_with('\r')) line.pop_back();
      if (line.starts_with("vt ")) answer += "\n" + line;
    }
    if (expected.empty()) expected = answer;
    EXPECT_EQ(answer, expected) << name;
  }
}

TEST_F(FlattenFiles, WritesAPolygonThatASeamGoesAcrossAsTriangles) {
  Put("tube.obj", Tube());
  // From corner to corner of a quad in every row.
  Put("seam.txt", "1 9 17 25\n");
  const Outcome outcome = Flatten("tube.obj", {"--seams", Path("seam.txt")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.err,
              HasSubstr("split_polygons: faces that the layout cuts across are written "
                        "as triangles"));
  EXPECT_THAT(outcome.err, HasSubstr("(3 in all)"));
  const Layout before = Split(Tube()), after = Split(Slurp(Path("flat.obj")));
  EXPECT_EQ(after.uv.size(), static_cast<std::size_t>((kColumns + 1) * (kRows + 1) + 4));
  EXPECT_EQ(after.others.size(), before.others.size() + 3);
  for (const char* triangle : {"f 1/1 2/2 9/9", "f 1/1 9/9 8/8", "f 17/17 25/25 24/24"}) {
    EXPECT_EQ(std::count(after.others.begin(), after.others.end(), triangle), 1) << triangle;
  }
  EXPECT_THAT(after.others, testing::Contains("f 2/2 3/3 10/10 9/9"));
}

TEST_F(FlattenFiles, AnOffFileBecomesAnObjFile) {
  Put("square.off", "off 4 1\n0 0 0\n8 0 0\n8 6 0\n0 6 0\n4 0 1 2 3\n");
  const Outcome outcome = Flatten("square.off");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const std::string text = Slurp(Path("flat.obj"));
  EXPECT_THAT(text, HasSubstr("v 8 6 0\nv 0 6 0\nvt "));
  EXPECT_THAT(text, HasSubstr("\nf 1/1 2/2 3/3 4/4\n"));
  EXPECT_EQ(outcome.err, "arapctl: warning: written_anew: " + Path("flat.obj") +
                             " is written anew, with the vertices, faces and objects of " +
                             Path("square.off") + "\n");
}

TEST_F(FlattenFiles, WhatIsPassedOverIsToldAndWhatIsWrongHasALine) {
  Put("sheet.obj", "v 0 0\nv 8 0\nv 8 6\nv 0 6\nhair 7\nf 1 2 3 4\n");
  const Outcome told = Flatten("sheet.obj");
  EXPECT_EQ(told.code, 0);
  EXPECT_EQ(told.err,
            "arapctl: warning: unknown_statements: " + Path("sheet.obj") +
                ":5: unknown statements are passed over, the first is 'hair' (1 in all)\n");
  Put("comma.obj", "v 0,0 0,0 0,5\nv 10,25 0,0 0,5\nv 0 10,75 0,5\nf 1 2 3\n");
  const Outcome comma = Flatten("comma.obj");
  EXPECT_EQ(comma.code, 3);
  EXPECT_THAT(comma.err,
              HasSubstr(Path("comma.obj") + ":1: '0,0' is not a number (decimal comma?)"));
  Put("claim.off", "OFF\n2000000000 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  const Outcome claim = Flatten("claim.off");
  EXPECT_EQ(claim.code, 3);
  EXPECT_THAT(claim.err, HasSubstr(Path("claim.off") + ":2: '2000000000'"));
  const Outcome alone = Arapctl(
      {"flatten", Path("sheet.obj"), "--spawn", "--report", Path("r.json"), "--vt", "unit"});
  EXPECT_EQ(alone.code, 2);
  EXPECT_THAT(alone.err, HasSubstr("--out"));
}

}  // namespace
}  // namespace arap::cli
