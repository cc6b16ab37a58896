// What the reader of PLY makes of files as programs write them, and of damaged ones.
#include <limits>

#include <gmock/gmock.h>

#include "core/files/formats.h"
#include "tests/support/mesh_bytes.h"

namespace arap {
namespace {

using testing::BytesOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string Header(const std::string& format, const std::string& elements) {
  return "ply\nformat " + format + " 1.0\n" + elements + "end_header\n";
}
const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";
const std::string kVertices = "element vertex 4\n" + kXyz;
const std::string kFaces = "element face 2\nproperty list uchar int vertex_indices\n";
const std::string kPoints = "0 0 0\n1 0 0\n1 1 0\n0 1 0.5\n";
const std::string kCorners = "3 0 1 2\n3 0 2 3\n";
const std::string kPlain = Header("ascii", kVertices + kFaces) + kPoints + kCorners;

std::string Replaced(std::string text, const std::string& what, const std::string& with) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += with.size()) {
    text.replace(at, what.size(), with);
  }
  return text;
}

struct Written {
  const char* name;
  std::string bytes;
  std::string passed_over;  // the names, as the warning has them
};
std::ostream& operator<<(std::ostream& out, const Written& written) { return out << written.name; }

class PlyFiles : public ::testing::TestWithParam<Written> {};

TEST_P(PlyFiles, AreTheSquare) {
  const auto file = ParsePly(GetParam().bytes, "a.ply");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_THAT(file->mesh.vertices,
              ElementsAre(Point3{0, 0, 0}, Point3{1, 0, 0}, Point3{1, 1, 0}, Point3{0, 1, 0.5}));
  EXPECT_THAT(file->mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
  EXPECT_EQ(file->has_extras, !GetParam().passed_over.empty());
  ASSERT_EQ(file->warnings.size(), GetParam().passed_over.empty() ? 0u : 1u);
  if (file->warnings.empty()) return;
  EXPECT_EQ(file->warnings[0].kind, "unknown_properties");
  EXPECT_THAT(file->warnings[0].message, HasSubstr(": " + GetParam().passed_over + " ("));
}

// Every vertex with more around its coordinates, every face with more around its corners.
std::string WithExtras(bool big) {
  std::string bytes = Header(
      big ? "binary_big_endian" : "binary_little_endian",
      "comment made by hand\nobj_info # 1\nelement camera 1\nproperty double angle\n"
      "element vertex 4\nproperty uint8 red\nproperty int16 x\nproperty list ushort float weights\n"
      "property float64 y\nproperty float z\nelement face 2\nproperty int8 flags\n"
      "property list uint32 uint16 vertex_index\nproperty list uchar double texcoord\n");
  bytes += BytesOf(1.5, big);
  for (const Point3& p : {Point3{0, 0, 0}, Point3{1, 0, 0}, Point3{1, 1, 0}, Point3{0, 1, 0.5}}) {
    bytes += '\7' + BytesOf(static_cast<std::int16_t>(p[0]), big);
    bytes += BytesOf(std::uint16_t{2}, big) + BytesOf(0.25F, big) +
             BytesOf(std::numeric_limits<float>::quiet_NaN(), big);
    bytes += BytesOf(p[1], big) + BytesOf(static_cast<float>(p[2]), big);
  }
  for (const Triangle& t : {Triangle{0, 1, 2}, Triangle{0, 2, 3}}) {
    bytes += '\1' + BytesOf(std::uint32_t{3}, big);
    for (const std::uint32_t v : t) bytes += BytesOf(static_cast<std::uint16_t>(v), big);
    bytes += '\1' + BytesOf(0.5, big);
  }
  return bytes;
}

INSTANTIATE_TEST_SUITE_P(
    Written, PlyFiles,
    ::testing::Values(
        Written{"plain", kPlain, ""}, Written{"crlf", Replaced(kPlain, "\n", "\r\n"), ""},
        Written{"cr", Replaced(kPlain, "\n", "\r"), ""},
        Written{"byte_order_mark", "\xef\xbb\xbf" + kPlain, ""},
        Written{"no_last_end", kPlain.substr(0, kPlain.size() - 1), ""},
        Written{"blank_lines", Replaced(kPlain, "0.5\n", "0.5\n\n \n") + "\n", ""},
        Written{"quad",
                Header("ascii", kVertices + "element face 1\n"
                                            "property list uchar int vertex_index\n") +
                    kPoints + "4 0 1 2 3\n",
                ""},
        Written{"faces_first", Header("ascii", kFaces + kVertices) + kCorners + kPoints, ""},
        Written{"empty_elements",
                Header("ascii", kVertices + kFaces + "element edge 0\nelement material 0\n") +
                    kPoints + kCorners,
                "'edge', 'material'"},
        Written{"colours",
                Header("ascii", kVertices + "property uchar red\nproperty uchar green\n" + kFaces) +
                    "0 0 0 255 0\n1 0 0 255 0\n1 1 0 255 0\n0 1 0.5 255 0\n" + kCorners,
                "'red', 'green'"},
        Written{"edges",
                Header("ascii", kVertices +
                                    "element edge 1\nproperty int vertex1\n"
                                    "property int vertex2\n" +
                                    kFaces) +
                    kPoints + "0 1\n" + kCorners,
                "'edge'"},
        Written{"little_endian", WithExtras(false),
                "'camera', 'red', 'weights', 'flags', 'texcoord'"},
        Written{"big_endian", WithExtras(true), "'camera', 'red', 'weights', 'flags', 'texcoord'"},
        Written{"cr_before_bytes",
                Replaced(Header("binary_little_endian",
                                "element face 2\nproperty list char char vertex_indices\n"
                                "element vertex 4\nproperty char x\nproperty char y\n"
                                "property float z\n"),
                         "\n", "\r") +
                    std::string("\3\0\1\2\3\0\2\3\0\0\0\0\0\0\1\0\0\0\0\0\1\1\0\0\0\0\0\1", 28) +
                    BytesOf(0.5F),
                ""}),
    [](const auto& each) { return std::string(each.param.name); });

// Many names are not all told.
TEST(Ply, TheWarningStaysShort) {
  std::string properties, values;
  for (int k = 0; k < 20; ++k) {
    properties += "property int p" + std::to_string(k) + "\n";
    values += " 1";
  }
  const auto file = ParsePly(Header("ascii", kVertices + kFaces + properties) + kPoints +
                                 "3 0 1 2" + values + "\n3 0 2 3" + values + "\n",
                             "a");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->warnings[0].message,
            "a: properties and elements are passed over: 'p0', 'p1', 'p2', 'p3', 'p4', 'p5', 'p6', "
            "'p7', … (20 in all)");
}

TEST(Ply, FaultsNameThePlace) {
  const std::string binary = Header("binary_little_endian", kVertices + kFaces);
  std::string bytes;
  for (const double x : {0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., .5}) {
    bytes += BytesOf(static_cast<float>(x));
  }
  const auto face = [](std::int32_t c) { return '\3' + BytesOf(0) + BytesOf(1) + BytesOf(c); };
  const std::size_t at = binary.size();
  const auto byte = [at](std::size_t behind) { return "a: byte " + std::to_string(at + behind); };
  std::string nan = bytes;
  nan.replace(16, 4, BytesOf(std::numeric_limits<float>::infinity()));
  const std::pair<std::string, std::string> cases[] = {
      {"", "a:1: a PLY file begins with 'ply'"},
      {"ply\n", "a:1: the file ends within the header: 'end_header' is missing"},
      {"ply\nformat binary 1.0\n", "a:2: 'binary' is no format of PLY"},
      {"ply\nformat ascii 2.0\n", "a:2: '2.0': only version 1.0 is read"},
      {"ply\nend_header\n", "a:2: the header names no format"},
      {"ply\nelements 3\n", "a:2: 'elements' is no keyword of a header"},
      {"ply\nelement vertex -3\n", "a:2: '-3' is not a count of elements"},
      {"ply\nelement vertex 3\nelement vertex 3\n", "a:3: 'vertex' is there twice"},
      {"ply\nproperty int x\n", "a:2: a property without an element"},
      {"ply\nelement vertex 3\nproperty real x\n", "a:3: 'real' is no type of PLY"},
      {"ply\nelement vertex 3\nproperty int x\nproperty int x\n", "a:4: 'x' is there twice"},
      {"ply\nelement vertex 3\nproperty list float int x\n",
       "a:3: the length of a list has to be a whole number"},
      {Header("ascii", kVertices) + kPoints, "a: no faces, or no vertices"},
      {Header("ascii", "element vertex 4\nproperty int x\nproperty int y\n" + kFaces),
       "a:3: the vertices have no z"},
      {Header("ascii", kVertices + "element face 2\nproperty list uchar float vertex_indices\n"),
       "a:7: the faces have no list of whole numbers 'vertex_indices'"},
      {Header("ascii", kVertices + kFaces + "element tristrips 1\nproperty list int int v\n"),
       "a:9: 'tristrips': triangle strips are not read"},
      {Header("ascii", kVertices + kFaces + "element x 2000000000\n"),
       "a:9: 'x' has no properties"},
      {Replaced(kPlain, "vertex 4", "vertex 2000000000"),
       "a:3: '2000000000': the header claims 2000000000 elements 'vertex', the file has room for "
       "7"},
      {Replaced(kPlain, "face 2", "face 3000000000"),
       "a:7: '3000000000': the header claims 3000000000 elements 'face', the file has room for 2"},
      {Replaced(kPlain, "face 2", "face 1"),
       "a:15: '3': the file goes on behind what the header claims"},
      {Replaced(kPlain, "3 0 2 3\n", "# 3 0 2 3\n"),
       "a:16: the file ends before what the header claims"},
      {Replaced(kPlain, "3 0 2 3", "3 0 2"),
       "a:15: the line ends before all its properties are there"},
      {Replaced(kPlain, "3 0 2 3", "3000000000 0 2"),
       "a:15: the line ends before all its properties are there"},
      {Replaced(kPlain, "3 0 2 3", "3 0 2 3 1"), "a:15: '1' is one word too many"},
      {Replaced(kPlain, "3 0 2 3", "3 0 2 4"),
       "a:15: '4': there is no such vertex, they go from 0 to 3"},
      {Replaced(kPlain, "3 0 2 3", "3 0 2 -1"),
       "a:15: '-1': there is no such vertex, they go from 0 to 3"},
      {Replaced(kPlain, "3 0 2 3", "3 0 2 1.5"), "a:15: '1.5' is not a whole number"},
      {Replaced(kPlain, "3 0 2 3", "2 0 2"), "a:15: '2': a face has three corners or more"},
      {Replaced(kPlain, "0.5", "nan"), "a:13: 'nan' is not a finite number"},
      {Replaced(kPlain, "0.5", "0,5"), "a:13: '0,5' is not a number (decimal comma?)"},
      {Replaced(kPlain, "0.5", "1e999"), "a:13: '1e999' is too large for a number"},
      {binary + nan + face(2) + face(3), byte(16) + ": inf is not a finite number"},
      {binary + bytes + face(2) + face(4),
       byte(70) + ": '4': there is no such vertex, they go from 0 to 3"},
      {binary + bytes + face(2) + face(-1),
       byte(70) + ": '-1': there is no such vertex, they go from 0 to 3"},
      {binary + bytes + face(2) + '\2' + face(3).substr(1),
       byte(61) + ": '2': a face has three corners or more"},
      {binary + bytes + face(2) + '\4' + face(3).substr(1),
       byte(74) + ": the file ends before what the header claims"},
      {binary + bytes + face(2) + face(3) + face(3),
       byte(74) + ": the file goes on for 13 bytes behind what the header claims"},
      {Replaced(binary, "vertex 4", "vertex 2000000000") + bytes,
       "a:3: '2000000000': the header claims 2000000000 elements 'vertex', the file has room for "
       "4"},
      {Replaced(binary, "list uchar int", "list uint int") + bytes + BytesOf(4000000000U) +
           std::string(40, '\0'),
       "a: byte " + std::to_string(at - 1 + 48 + 4 + 40) +
           ": the file ends before what the header claims"},
  };
  for (const auto& [text, message] : cases) {
    const auto file = ParsePly(text, "a");
    ASSERT_FALSE(file) << message;
    EXPECT_EQ(file.error(), Fault(FaultKind::kInvalidOption, message));
  }
}

}  // namespace
}  // namespace arap
