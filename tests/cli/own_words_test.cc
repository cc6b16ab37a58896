// What a server says, with the numbers, lines and flags of who wrote the files.
#include "client/cli/commands/own_words.h"

#include <gmock/gmock.h>

#include "client/cli/commands/flatten_flags.h"
#include "client/cli/commands/flatten_inputs.h"
#include "client/cli/report.h"

namespace arap::cli {
namespace {

const Counting kObj{1, {}};
const Counting kLines{1, [](std::uint32_t triangle) { return std::size_t{100} + triangle; }};

const Counting kFaces{0, [](std::uint32_t triangle) { return std::size_t{triangle} / 2; }, false};

TEST(OwnWords, AFileCountsAsItsFormatDoesWhateverItIsCalled) {
  SurfaceFile file;  // of a quad and a triangle
  file.first_corner = {0, 4, 7};
  file.first_triangle = {0, 2, 3};
  const auto told = [&file] {
    return InOwnWords("vertex 3, triangles 1, 2 and 3", CountingOf(file));
  };
  EXPECT_EQ(told(), "vertex 3, triangles of faces 0, 1 and 0");
  file.face_numbers = {4, 6};
  EXPECT_EQ(told(), "vertex 3, triangles of faces 4, 6 and 0");
  file.face_lines = {7, 9};
  EXPECT_EQ(told(), "vertex 3, triangles at lines 7, 9 and 0");
  file.text = "v 0 0 0\n";  // that of an OBJ file
  EXPECT_EQ(told(), "vertex 4, triangles at lines 7, 9 and 0");
}

TEST(OwnWords, NumbersBehindTheWordsForElementsAreTheFiles) {
  const struct {
    const char* said;
    const char* obj;
    const char* lines;
  } cases[] = {
      {"A seam runs from vertex 0 to vertex 19.", "A seam runs from vertex 1 to vertex 20.",
       "A seam runs from vertex 1 to vertex 20."},
      {"Triangle 3 is degenerate: below 1e-12 (3 in all).",
       "Triangle 4 is degenerate: below 1e-12 (3 in all).",
       "Triangle at line 103 is degenerate: below 1e-12 (3 in all)."},
      {"Triangles 3 and 7 differ.", "Triangles 4 and 8 differ.",
       "Triangles at lines 103 and 107 differ."},
      {"The pins of vertices 1, 2 and 3 flip triangle 4.",
       "The pins of vertices 2, 3 and 4 flip triangle 5.",
       "The pins of vertices 2, 3 and 4 flip triangle at line 104."},
      {"Edge 3-7 belongs to more than two triangles: 1, 2, 3, ….",
       "Edge 4-8 belongs to more than two triangles: 2, 3, 4, ….",
       "Edge 4-8 belongs to more than two triangles: at lines 101, 102, 103, …."},
      {"Triangle 2 names vertex 9, but the mesh has 5 vertices.",
       "Triangle 3 names vertex 10, but the mesh has 5 vertices.",
       "Triangle at line 102 names vertex 10, but the mesh has 5 vertices."},
      {"vertex 4294967295", "vertex 4294967296", "vertex 4294967296"},
      // No numbers of elements.
      {"2 triangles, 3 of them", "2 triangles, 3 of them", "2 triangles, 3 of them"},
      {"my_vertex 3 and vertex3", "my_vertex 3 and vertex3", "my_vertex 3 and vertex3"},
      {"vertex ", "vertex ", "vertex "},
      {"", "", ""},
      // Options are flags.
      {"give seams or set auto_cut.", "give seams or set --auto-cut.",
       "give seams or set --auto-cut."},
      {"2 were welded; weld with drop_duplicates.", "2 were welded; --weld with --drop-duplicates.",
       "2 were welded; --weld with --drop-duplicates."},
  };
  for (const auto& c : cases) {
    EXPECT_EQ(InOwnWords(c.said, Counting{}).substr(0, 6), std::string(c.said).substr(0, 6));
    EXPECT_EQ(InOwnWords(c.said, kObj), c.obj);
    EXPECT_EQ(InOwnWords(c.said, kLines), c.lines);
  }
}

// The surface skirt.obj with seams, pins, rigidity and grain lines.
class FlattenOrigins : public testing::Test {
 protected:
  FlattenOrigins() {
    flags_.surface = "skirt.obj";
    flags_.seams = "s.txt";
    flags_.pins = "p.txt";
    flags_.rigidity = "r.txt";
    flags_.grain = {"1,2", "3,4,90"};
    texts_.seams = "1 2 3\n# between\n4 5\n";
    texts_.pins = "\n1 0 0\n2 1 1 # here\n";
    texts_.rigidity = "1\n\n2\n";
  }

  std::string Said(const Fault& fault, const Counting& mesh = kObj) const {
    return Describe(InOwnWords(fault, OriginsOf(flags_, texts_, mesh)));
  }

  FlattenFlags flags_;
  FlattenTexts texts_;
};

TEST_F(FlattenOrigins, FaultsNameTheFlagTheFileAndTheLine) {
  const Fault seam = Fault(FaultKind::kUnknownEdge,
                           "A seam runs from vertex 3 to vertex 4, which is no edge of the mesh.")
                         .Field("seam_edges[4]")
                         .Elements({3, 4});
  EXPECT_EQ(
      Said(seam),
      "UNKNOWN_EDGE: --seams s.txt:3: A seam runs from vertex 4 to vertex 5, which is no edge "
      "of the mesh.");
  EXPECT_EQ(
      Said(Fault(FaultKind::kInvalidOption,
                 "pins[1] is 1e9 away from 0; at most 1e6 times the size is allowed.")
               .Field("pins[1]")
               .Element(1)
               .Detail("limit", "5")),
      "INVALID_OPTION: --pins p.txt:3: the pin is 1e9 away from 0; at most 1e6 times the size "
      "is allowed. (limit = 5)");
  EXPECT_EQ(Said(Fault(FaultKind::kInvalidOption, "pins[0].weight is 1e12; it must be 0 or less.")
                     .Field("pins[0].weight")),
            "INVALID_OPTION: --pins p.txt:2: weight is 1e12; it must be 0 or less.");
  EXPECT_EQ(Said(Fault(FaultKind::kInvalidOption, "Vertex 1 is pinned twice.")
                     .Field("pins[1].vertex")
                     .Element(1)),
            "INVALID_OPTION: --pins p.txt:3: Vertex 2 is pinned twice.");
  EXPECT_EQ(Said(Fault(FaultKind::kNotInjective, "The pins of vertices 0, 1 and 2 flip triangle 3.")
                     .Field("pins")
                     .Element(3)),
            "NOT_INJECTIVE: --pins p.txt: The pins of vertices 1, 2 and 3 flip triangle 4. "
            "(triangles = 4)");
  EXPECT_EQ(Said(Fault(FaultKind::kInvalidOption, "Vertices 2 and 3 are on no common chart.")
                     .Field("grain_lines[1]")
                     .Elements({2, 3})),
            "INVALID_OPTION: --grain 3,4,90: Vertices 3 and 4 are on no common chart.");
  EXPECT_EQ(Said(Fault(FaultKind::kInvalidOption,
                       "The chart of grain_lines[0] has one already, or several pins.")
                     .Field("grain_lines[0]")),
            "INVALID_OPTION: --grain 1,2: The chart of the line has one already, or several pins.");
  EXPECT_EQ(Said(Fault(FaultKind::kInvalidOption, "refine of 5 is more than max_refine of 3.")
                     .Field("refine")),
            "INVALID_OPTION: --refine: refine of 5 is more than max_refine of 3.");
}

TEST_F(FlattenOrigins, JsonSeamsCountFromZero) {
  const Fault seam = Fault(FaultKind::kUnknownEdge, "A seam runs from vertex 3 to vertex 4.")
                         .Field("seam_edges[2]")
                         .Elements({3, 4});
  texts_.seams = "[[0, 1],\n  [3, 4]]";
  EXPECT_EQ(Said(seam), "UNKNOWN_EDGE: --seams s.txt:2:3: A seam runs from vertex 3 to vertex 4.");
  texts_.seams = "{\"cut_edges\":\n [0, 1, 3, 4]}";
  EXPECT_EQ(Said(seam), "UNKNOWN_EDGE: --seams s.txt:2:9: A seam runs from vertex 3 to vertex 4.");
}

TEST_F(FlattenOrigins, FaultsOfTheMeshNameItsFile) {
  const Fault degenerate = Fault(FaultKind::kDegenerateTriangle,
                                 "Triangle 3 is degenerate; tolerate_degenerate lets it.")
                               .Field("mesh.triangles")
                               .Elements({3, 5});
  EXPECT_EQ(Said(degenerate),
            "DEGENERATE_TRIANGLE: skirt.obj: Triangle 4 is degenerate; --tolerate-degenerate lets "
            "it. (triangles = 4 6)");
  EXPECT_EQ(Said(degenerate, kLines),
            "DEGENERATE_TRIANGLE: skirt.obj:103: Triangle at line 103 is degenerate; "
            "--tolerate-degenerate lets it. (lines = 103 105)");
  EXPECT_EQ(Said(degenerate, kFaces),
            "DEGENERATE_TRIANGLE: skirt.obj: face 1: Triangle of face 1 is degenerate; "
            "--tolerate-degenerate lets it. (faces = 1 2)");
  EXPECT_EQ(Said(Fault(FaultKind::kNonManifoldVertex, "Parts touch in vertex 7 only.")
                     .Field("mesh.triangles")
                     .Element(7)),
            "NON_MANIFOLD_VERTEX: skirt.obj: Parts touch in vertex 8 only. (vertices = 8)");
  EXPECT_EQ(Said(Fault(FaultKind::kNonManifoldEdge, "Edge 3-7 has more than two triangles.")
                     .Field("mesh.triangles")
                     .Detail("edge", "3-7")),
            "NON_MANIFOLD_EDGE: skirt.obj: Edge 4-8 has more than two triangles. (edge = 4-8)");
}

TEST_F(FlattenOrigins, HandlesCountAsTheyAreSent) {
  EXPECT_EQ(Said(Fault(FaultKind::kConflictingHandles, "wrong").Field("pins").Elements({0, 3})),
            "CONFLICTING_HANDLES: --pins p.txt: wrong (handles = 0 3)");
}

// Of a newer server, or of nothing that a file says.
TEST_F(FlattenOrigins, OtherFaultsStayAsTheyAre) {
  for (const char* field : {"", "pinsel[3]", "mesher", "max_response_bytes"}) {
    const Fault fault = Fault(FaultKind::kInvalidOption, "vertex 3").Field(field).Element(3);
    EXPECT_EQ(InOwnWords(fault, OriginsOf(flags_, texts_, kObj)), fault) << field;
  }
  // Fields as no server writes them.
  for (const char* field :
       {"pins[", "pins[]", "pins[x]", "pins[99999999999999999999]", "pins[7]"}) {
    EXPECT_THAT(Said(Fault(FaultKind::kInvalidOption, "wrong").Field(field)),
                testing::HasSubstr("--pins p.txt"));
  }
}

TEST(OwnWords, WarningsCountAsTheFileToo) {
  const auto said = [](const char* kind, std::vector<std::uint32_t> elements,
                       const Counting& counting) {
    Warning warning{kind, elements.size(), std::move(elements), "vertex 3 and triangle 0"};
    return InOwnWords({std::move(warning)}, counting)[0].message;
  };
  EXPECT_EQ(said("kind", {3}, kObj), "vertex 4 and triangle 1");
  EXPECT_EQ(said("twin_vertices", {3, 5}, kLines),
            "vertex 4 and triangle at line 100 (vertices 4 6)");
  EXPECT_EQ(said("dropped_triangles", {3, 5}, kObj), "vertex 4 and triangle 1 (triangles 4 6)");
  EXPECT_EQ(said("dropped_triangles", {0, 1, 2, 3, 4, 5}, kLines),
            "vertex 4 and triangle at line 100 (lines 100 101 102 103 104 …)");
  EXPECT_EQ(said("dropped_triangles", {3, 5}, kFaces),
            "vertex 3 and triangle of face 0 (faces 1 2)");
  EXPECT_EQ(said("t_junctions", {}, kObj), "vertex 4 and triangle 1");
}

}  // namespace
}  // namespace arap::cli
