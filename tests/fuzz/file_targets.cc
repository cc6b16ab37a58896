// The readers of mesh files, and the writer that keeps the text of one or makes one.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "core/files/bytes.h"
#include "core/files/formats.h"
#include "core/files/obj_writer.h"
#include "tests/fuzz/check.h"
#include "tests/fuzz/memory_cap.h"
#include "tests/fuzz/targets.h"

namespace arap::fuzz {
namespace {

template <class Value>
std::size_t BytesOf(const std::vector<Value>& values) {
  return values.capacity() * sizeof(Value);
}

// What a surface holds, reserved or filled.
std::size_t BytesOf(const SurfaceFile& file) {
  std::size_t bytes = file.text.capacity() + BytesOf(file.mesh.vertices) +
                      BytesOf(file.mesh.triangles) + BytesOf(file.warnings) +
                      BytesOf(file.corners) + BytesOf(file.first_corner) +
                      BytesOf(file.first_triangle) + BytesOf(file.face_lines) +
                      BytesOf(file.face_numbers) + BytesOf(file.names) + BytesOf(file.parts);
  for (const std::string& name : file.names) bytes += name.capacity();
  return bytes;
}

// Warnings, and what a string has at least.
constexpr std::size_t kFixedBytes = std::size_t{64} << 10U;

void CheckSurface(const SurfaceFile& file, std::size_t size, std::size_t fixed) {
  Promise(BytesOf(file) <= fixed + 20 * size, "a surface takes no more than its file allows");
  for (const Point3& p : file.mesh.vertices) {
    for (const double x : p) CheckFinite(x, "vertex");
  }
  for (const Triangle& t : file.mesh.triangles) {
    for (const std::uint32_t v : t) {
      Promise(v < file.mesh.vertices.size(), "a triangle has vertices that are there");
    }
  }
  const std::size_t faces = file.face_count();
  Promise(faces > 0, "a surface has faces");
  Promise(file.first_corner.size() == faces + 1 && file.first_corner.back() == file.corners.size(),
          "every face has its corners");
  Promise(file.first_triangle.size() == faces + 1 &&
              file.first_triangle.back() == file.mesh.triangles.size(),
          "every face has its triangles");
  for (std::size_t f = 0; f < faces; ++f) {
    Promise(file.CornersOf(f).size() >= 3, "a face has three corners or more");
    Promise(file.first_triangle[f] < file.first_triangle[f + 1], "a face has a triangle");
    Promise(file.ObjectOf(f).size() + file.GroupOf(f).size() <= size,
            "names are those of the file");
  }
}

// Written with a layout and read again it is the same surface, and the same text from then on.
void CheckWriting(const SurfaceFile& file) {
  std::vector<Complex> uv;
  for (std::size_t v = 0; v < file.mesh.vertices.size(); ++v) {
    uv.emplace_back(0.5, static_cast<double>(v));
  }
  std::vector<Warning> warnings;
  const std::string text = FormatLayout(file, uv, file.mesh.triangles, warnings);
  Promise(warnings.empty(), "a layout without a cut cuts no face");
  const auto again = ParseObj(text, "again");
  Promise(again.has_value(), "what is written can be read", text.c_str());
  Promise(again->mesh == file.mesh, "what is written is the same surface", text.c_str());
  const std::string twice = FormatLayout(*again, uv, again->mesh.triangles, warnings);
  Promise(twice == text, "what is written once more is the same text", text.c_str());
}

void CheckFile(const Result<SurfaceFile>& file, std::size_t size, std::size_t fixed = kFixedBytes) {
  if (!file) return CheckFault(file.error());
  CheckSurface(*file, size, fixed);
  CheckWriting(*file);
}

std::string TextOf(const std::uint8_t* data, std::size_t size) { return {data, data + size}; }

}  // namespace

void Obj(const std::uint8_t* data, std::size_t size) {
  CheckFile(Capped(size, [&] { return ParseObj(TextOf(data, size), "fuzz"); }), size);
}

void Off(const std::uint8_t* data, std::size_t size) {
  CheckFile(Capped(size, [&] { return ParseOff(TextOf(data, size), "fuzz"); }), size);
}

void Stl(const std::uint8_t* data, std::size_t size) {
  CheckFile(Capped(size, [&] { return ParseStl(TextOf(data, size), "fuzz"); }), size);
}

void Ply(const std::uint8_t* data, std::size_t size) {
  CheckFile(Capped(size, [&] { return ParsePly(TextOf(data, size), "fuzz"); }), size);
}

void Gltf(const std::uint8_t* data, std::size_t size) {
  // Nodes may repeat a mesh to 4 MiB, in vectors that are up to twice as large.
  constexpr std::size_t kRepeated = std::size_t{8} << 20U;
  const LoadBeside load = [](const std::string& path, std::size_t least) -> Result<std::string> {
    if (path.size() % 2 == 0) return Fail(FaultKind::kNotFound, "not there");
    return std::string(std::min<std::size_t>(least, 64), '\1');
  };
  CheckFile(Capped(size, [&] { return ParseGltf(TextOf(data, size), "fuzz", load); }), size + 64,
            kRepeated + kFixedBytes);
}

void Gzip(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kMost = std::size_t{1} << 20U;
  const Result<std::string> text =
      Capped(size, [&] { return Unpack(TextOf(data, size), "fuzz", kMost); });
  if (!text) return CheckFault(text.error());
  Promise(text->size() <= kMost, "no more is unpacked than is allowed");
}

}  // namespace arap::fuzz
