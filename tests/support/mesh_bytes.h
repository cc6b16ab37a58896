// Meshes as the bytes of files of every format, for tests of who reads them. Nothing here shares code
// with the readers.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "arap/model/mesh.h"

namespace arap::testing {

// A mesh of polygons.
struct Polygons {
  std::vector<Point3> vertices;
  std::vector<std::vector<std::uint32_t>> faces;
};

// A quarter of a tube of quads, with coordinates that a float holds exactly: `radius` about the z
// axis, each row `step` high.
Polygons QuarterTube(int columns, int rows, double radius, double step);
// Each face from its first corner.
std::vector<Triangle> Fans(const Polygons& mesh);

// A number as bytes, the lowest first or last.
template <class Number>
std::string BytesOf(Number number, bool big_endian = false) {
  const char* const raw = reinterpret_cast<const char*>(&number);
  std::string bytes(raw, sizeof(Number));
  return big_endian ? std::string(bytes.rbegin(), bytes.rend()) : bytes;
}

std::string ObjOf(const Polygons& mesh);
std::string OffOf(const Polygons& mesh);
std::string StlTextOf(const Polygons& mesh);
// `header` is filled up to 80 bytes.
std::string StlBytesOf(const Polygons& mesh, std::string header = "");
// Of this format: "ascii", "binary_little_endian" or "binary_big_endian". Coordinates are doubles.
std::string PlyOf(const Polygons& mesh, std::string_view format);
// The JSON of one mesh in one node, its buffer in base 64.
std::string GltfOf(const Polygons& mesh);
std::string GlbOf(const Polygons& mesh);
// The container around a JSON and a buffer.
std::string GlbOf(std::string json, std::string buffer);
std::string Base64(std::string_view bytes);

std::string Packed(std::string_view bytes);  // by gzip

// The same mesh in every format, each by itself and packed: the name of a file, and its bytes.
std::vector<std::pair<std::string, std::string>> InEveryFormat(const Polygons& mesh);

}  // namespace arap::testing
