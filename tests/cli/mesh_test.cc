// arapctl mesh: what the triangles of figures are, and what is said of images that have none.
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <sstream>
#include <utility>

#include <gmock/gmock.h>

#include "core/base/plane.h"
#include "core/files/mesh_file.h"
#include "tests/cli/png.h"
#include "tests/cli/run.h"

namespace arap::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

// A figure on transparent ground: inside where depth(x, y) > 0, in pixels with y down; soft edges.
template <class Depth>
std::string FigurePng(std::size_t width, std::size_t height, Depth depth) {
  return DrawnPng(width, height, [&](double x, double y) {
    const double alpha = std::clamp(127.5 + 255 * depth(x, y), 0.0, 255.0);
    return Pixel{200, 100, 50, static_cast<std::uint8_t>(std::lround(alpha))};
  });
}

double Disc(double x, double y, double middle_x, double middle_y, double radius) {
  return radius - std::hypot(x - middle_x, y - middle_y);
}

struct Counts {
  double area = 0;
  std::size_t components = 0;
  std::ptrdiff_t euler = 0;  // vertices − edges + triangles
  double smallest_angle = 180;
};

Counts CountsOf(const PlanarMesh& mesh) {
  Counts counts;
  std::set<std::pair<std::uint32_t, std::uint32_t>> directed, edges;
  std::vector<std::uint32_t> root(mesh.vertices.size());
  for (std::uint32_t v = 0; v < root.size(); ++v) root[v] = v;
  const auto find = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v];
    return v;
  };
  for (const Triangle& t : mesh.triangles) {
    const double area = TwiceArea(t, mesh.vertices) / 2;
    EXPECT_GT(area, 0);
    counts.area += area;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
      EXPECT_TRUE(directed.emplace(a, b).second);
      edges.emplace(std::min(a, b), std::max(a, b));
      root[find(a)] = find(b);
      const Complex p = mesh.vertices[a], q = mesh.vertices[b], r = mesh.vertices[c];
      counts.smallest_angle =
          std::min(counts.smallest_angle, std::arg((r - p) / (q - p)) * 180 / std::numbers::pi);
    }
  }
  std::set<std::uint32_t> roots;
  for (std::uint32_t v = 0; v < root.size(); ++v) roots.insert(find(v));
  counts.components = roots.size();
  counts.euler = static_cast<std::ptrdiff_t>(mesh.vertices.size() + mesh.triangles.size()) -
                 static_cast<std::ptrdiff_t>(edges.size());
  return counts;
}

class MeshCommand : public FolderTest {
 protected:
  // Of the image with these bytes.
  Outcome Make(const std::string& png, const std::vector<std::string>& flags = {}) const {
    std::vector<std::string> arguments{"mesh", Put("image.png", png), "--out", Path("mesh.obj")};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    return Arapctl(arguments);
  }

  PlanarMesh Read() const {
    const auto mesh = ReadPlanarMesh(Path("mesh.obj"));
    EXPECT_TRUE(mesh) << mesh.error().message;
    return mesh ? *mesh : PlanarMesh();
  }

  // The mesh with checks that hold for every one.
  Counts Measure(const Outcome& outcome) const {
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    if (outcome.code != 0) return {};
    const Counts counts = CountsOf(Read());
    EXPECT_GE(counts.smallest_angle, 20);
    return counts;
  }
};

TEST_F(MeshCommand, ADiscIsADiskWithItsArea) {
  const Outcome outcome =
      Make(FigurePng(200, 150, [](double x, double y) { return Disc(x, y, 90, 80, 60); }));
  const Counts counts = Measure(outcome);
  EXPECT_EQ(outcome.err, "");
  EXPECT_THAT(outcome.out, HasSubstr("1 piece, 0 holes"));
  EXPECT_THAT(outcome.out, HasSubstr("within 1 pixel of"));
  EXPECT_EQ(counts.components, 1u);
  EXPECT_EQ(counts.euler, 1);
  // Within a pixel of the circle.
  EXPECT_NEAR(counts.area, std::numbers::pi * 60 * 60, 2 * std::numbers::pi * 60);
  const PlanarMesh mesh = Read();
  EXPECT_NEAR(static_cast<double>(mesh.vertices.size()), 1000, 150);
  for (const Complex p : mesh.vertices) EXPECT_LE(std::abs(p - Complex(90, 70)), 60.1);
}

TEST_F(MeshCommand, TextureCoordinatesArePlacesOnTheImage) {
  ASSERT_EQ(Make(FigurePng(200, 150, [](double x, double y) { return Disc(x, y, 90, 80, 60); }),
                 {"--density", "100"})
                .code,
            0);
  const PlanarMesh mesh = Read();
  std::istringstream lines(Slurp(Path("mesh.obj")));
  std::vector<Complex> uv;
  std::size_t faces = 0;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string key;
    words >> key;
    if (key == "vt") {
      double u = 0, v = 0;
      words >> u >> v;
      uv.emplace_back(u, v);
    } else if (key == "f") {
      ++faces;
      for (std::string word; words >> word;) {
        const std::size_t slash = word.find('/');
        EXPECT_EQ(word.substr(0, slash), word.substr(slash + 1)) << line;
      }
    }
  }
  EXPECT_EQ(faces, mesh.triangles.size());
  ASSERT_EQ(uv.size(), mesh.vertices.size());
  for (std::size_t i = 0; i < uv.size(); ++i) {
    EXPECT_NEAR(uv[i].real(), mesh.vertices[i].real() / 200, 1e-9);
    EXPECT_NEAR(uv[i].imag(), mesh.vertices[i].imag() / 150, 1e-9);
  }
}

TEST_F(MeshCommand, HolesAreKeptUnlessTheyAreToBeFilled) {
  const std::string ring = FigurePng(200, 200, [](double x, double y) {
    return std::min(Disc(x, y, 100, 100, 90), -Disc(x, y, 110, 100, 40));
  });
  const Counts counts = Measure(Make(ring));
  EXPECT_EQ(counts.components, 1u);
  EXPECT_EQ(counts.euler, 0);
  EXPECT_NEAR(counts.area, std::numbers::pi * (90 * 90 - 40 * 40), 2 * std::numbers::pi * 130);
  EXPECT_EQ(Measure(Make(ring, {"--fill-holes"})).euler, 1);
}

TEST_F(MeshCommand, EveryPieceIsAComponent) {
  const Outcome outcome = Make(FigurePng(300, 120, [](double x, double y) {
    return std::max(Disc(x, y, 60, 60, 50), Disc(x, y, 220, 60, 45));
  }));
  const Counts counts = Measure(outcome);
  EXPECT_THAT(outcome.out, HasSubstr("2 pieces"));
  EXPECT_EQ(counts.components, 2u);
  EXPECT_EQ(counts.euler, 2);
}

TEST_F(MeshCommand, AConcaveStarKeepsItsArea) {
  const auto depth = [](double x, double y) {
    const Complex p(x - 150, y - 150);
    return 80 + 40 * std::cos(5 * std::arg(p)) - std::abs(p);
  };
  const Counts counts = Measure(Make(FigurePng(300, 300, depth), {"--tolerance", "0.5"}));
  EXPECT_EQ(counts.euler, 1);
  // Its outline is about 730 long, and half a pixel of it may be missing.
  EXPECT_NEAR(counts.area, std::numbers::pi * (80 * 80 + 40 * 40 / 2), 365);
}

TEST_F(MeshCommand, TheBackgroundMayBeAColour) {
  const auto pixel = [](double x, double y) {
    const bool figure = Disc(x, y, 70, 60, 40) > 0;
    return figure ? Pixel{30, 60, 200} : Pixel{255, 255, 255};
  };
  const std::string png = DrawnPng(150, 120, pixel, /*alpha=*/false);
  for (const char* background : {"auto", "ffffff", "#fefefe"}) {
    const Outcome outcome = Make(png, {"--background", background});
    const Counts counts = Measure(outcome);
    EXPECT_EQ(outcome.err, "");
    EXPECT_NEAR(counts.area, std::numbers::pi * 40 * 40, 2 * std::numbers::pi * 40);
  }
  // Without it the whole image is the figure, which is told.
  const Outcome whole = Make(png);
  EXPECT_THAT(whole.err, HasSubstr("--background auto"));
  EXPECT_NEAR(Measure(whole).area, 150 * 120, 1e-3);
  EXPECT_EQ(Make(png, {"--background", "fffff"}).code, 2);
  EXPECT_EQ(Make(png, {"--background", "white"}).code, 2);
}

TEST_F(MeshCommand, SpecksAreLeftOutAndTold) {
  const std::string png = DrawnPng(200, 200, [](double x, double y) {
    const bool speck = std::fmod(x, 20) < 2 && std::fmod(y, 20) < 2;
    const double depth = Disc(x, y, 100, 100, 60);
    const bool inside = depth > 4 ? !speck : depth > 0 || (speck && depth < -4);
    return Pixel{0, 0, 0, static_cast<std::uint8_t>(inside ? 255 : 0)};
  });
  const Outcome outcome = Make(png);
  const Counts counts = Measure(outcome);
  EXPECT_THAT(outcome.err, HasSubstr("were left out (--specks)"));
  EXPECT_EQ(counts.components, 1u);
  EXPECT_EQ(counts.euler, 1);
  const Outcome all = Make(png, {"--specks", "0", "--tolerance", "0.1"});
  EXPECT_EQ(all.code, 0);
  EXPECT_THAT(all.err, Not(HasSubstr("--specks")));
  EXPECT_GT(CountsOf(Read()).components, 20u);
}

TEST_F(MeshCommand, ExpansionGoesOutwardsAndSaysWhenItLeavesTheImage) {
  const std::string png =
      FigurePng(120, 120, [](double x, double y) { return Disc(x, y, 60, 60, 40); });
  const Outcome outcome = Make(png, {"--expansion", "8", "--tolerance", "0.5"});
  EXPECT_EQ(outcome.err, "");
  // To half a pixel for the expansion and half a pixel for the outline.
  EXPECT_NEAR(Measure(outcome).area, std::numbers::pi * 48 * 48, 2 * std::numbers::pi * 48);
  EXPECT_THAT(outcome.out, HasSubstr("8 pixels further out"));
  EXPECT_THAT(Make(png, {"--expansion", "30"}).err, HasSubstr("beyond the image"));
}

TEST_F(MeshCommand, TheSameImageGivesTheSameBytes) {
  const std::string png = FigurePng(300, 300, [](double x, double y) {
    const Complex p(x - 150, y - 150);
    return std::min(100 + 40 * std::cos(7 * std::arg(p)) - std::abs(p), std::abs(p) - 20);
  });
  ASSERT_EQ(Make(png).code, 0);
  const std::string first = Slurp(Path("mesh.obj"));
  for (int i = 0; i < 5; ++i) {
    ASSERT_EQ(Make(png).code, 0);
    EXPECT_EQ(Slurp(Path("mesh.obj")), first);
  }
}

TEST_F(MeshCommand, ImagesWithoutAFigureAreRefused) {
  const auto clear = [](double, double) { return Pixel{0, 0, 0, 0}; };
  const auto full = [](double, double) { return Pixel{}; };
  const std::string disc =
      FigurePng(50, 50, [](double x, double y) { return Disc(x, y, 25, 25, 20); });
  const struct {
    const char* what;
    std::string bytes;
    const char* message;
  } cases[] = {
      {"transparent", DrawnPng(30, 20, clear), "nothing to mesh"},
      {"one pixel", DrawnPng(1, 1, full), "has 1 pixel"},
      {"one transparent pixel", DrawnPng(1, 1, clear), "nothing to mesh"},
      {"truncated", disc.substr(0, disc.size() / 2), "broken PNG"},
      {"no PNG", "P6 1 1 255 abc", "not a readable PNG"},
      {"an empty file", "", "not a readable PNG"},
      {"a huge claim", WithClaim(disc, 60'000, 60'000), "at most 16384 on a side"},
      {"a claim that the file does not hold", WithClaim(disc, 16'000, 4'000), "cannot hold"},
  };
  for (const auto& [what, bytes, message] : cases) {
    const Outcome outcome = Make(bytes);
    EXPECT_EQ(outcome.code, 3) << what;
    EXPECT_THAT(outcome.err, HasSubstr(message)) << what;
    EXPECT_EQ(outcome.out, "") << what;
    EXPECT_FALSE(ReadPlanarMesh(Path("mesh.obj"))) << what;
  }
  // A pixel is a mesh when it is wanted.
  const Outcome pixel = Make(DrawnPng(1, 1, full), {"--specks", "0"});
  EXPECT_EQ(pixel.code, 0) << pixel.err;
}

}  // namespace
}  // namespace arap::cli
