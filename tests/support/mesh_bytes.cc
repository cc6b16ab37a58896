#include "tests/support/mesh_bytes.h"

#include <cmath>
#include <cstddef>
#include <iterator>
#include <numbers>

#include <fmt/format.h>
#include <zlib.h>

namespace arap::testing {
namespace {

// The buffer of a glTF file: positions, then indices.
std::string GltfBuffer(const Polygons& mesh) {
  std::string bytes;
  for (const Point3& p : mesh.vertices) {
    for (const double x : p) bytes += BytesOf(static_cast<float>(x));
  }
  for (const Triangle& t : Fans(mesh)) {
    for (const std::uint32_t v : t) bytes += BytesOf(v);
  }
  return bytes;
}

// `buffer` is what the entry of the buffer says besides its length.
std::string GltfJson(const Polygons& mesh, const std::string& buffer) {
  const std::size_t vertices = mesh.vertices.size(), corners = 3 * Fans(mesh).size();
  return fmt::format(
      R"({{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],)"
      R"("nodes":[{{"mesh":0,"name":"tube"}}],)"
      R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],)"
      R"("accessors":[{{"bufferView":0,"componentType":5126,"count":{0},"type":"VEC3"}},)"
      R"({{"bufferView":1,"componentType":5125,"count":{1},"type":"SCALAR"}}],)"
      R"("bufferViews":[{{"buffer":0,"byteLength":{2}}},)"
      R"({{"buffer":0,"byteOffset":{2},"byteLength":{3}}}],)"
      R"("buffers":[{{"byteLength":{4}{5}}}]}})",
      vertices, corners, 12 * vertices, 4 * corners, 12 * vertices + 4 * corners, buffer);
}

}  // namespace

Polygons QuarterTube(int columns, int rows, double radius, double step) {
  Polygons mesh;
  for (int row = 0; row <= rows; ++row) {
    for (int column = 0; column <= columns; ++column) {
      const double angle = std::numbers::pi * column / (2 * columns);
      mesh.vertices.push_back({static_cast<float>(radius * std::cos(angle)),
                               static_cast<float>(radius * std::sin(angle)),
                               static_cast<float>(step * row)});
    }
  }
  const auto across = static_cast<std::uint32_t>(columns + 1);
  for (std::uint32_t row = 0; row < static_cast<std::uint32_t>(rows); ++row) {
    for (std::uint32_t column = 0; column + 1 < across; ++column) {
      const std::uint32_t a = row * across + column;
      mesh.faces.push_back({a, a + 1, a + across + 1, a + across});
    }
  }
  return mesh;
}

std::vector<Triangle> Fans(const Polygons& mesh) {
  std::vector<Triangle> triangles;
  for (const auto& face : mesh.faces) {
    for (std::size_t k = 2; k < face.size(); ++k) {
      triangles.push_back({face[0], face[k - 1], face[k]});
    }
  }
  return triangles;
}

std::string ObjOf(const Polygons& mesh) {
  std::string text;
  for (const Point3& p : mesh.vertices) text += fmt::format("v {} {} {}\n", p[0], p[1], p[2]);
  for (const auto& face : mesh.faces) {
    text += 'f';
    for (const std::uint32_t v : face) text += fmt::format(" {}", v + 1);
    text += '\n';
  }
  return text;
}

std::string OffOf(const Polygons& mesh) {
  std::string text = fmt::format("OFF\n{} {} 0\n", mesh.vertices.size(), mesh.faces.size());
  for (const Point3& p : mesh.vertices) text += fmt::format("{} {} {}\n", p[0], p[1], p[2]);
  for (const auto& face : mesh.faces) {
    text += fmt::format("{}", face.size());
    for (const std::uint32_t v : face) text += fmt::format(" {}", v);
    text += '\n';
  }
  return text;
}

std::string StlTextOf(const Polygons& mesh) {
  std::string text = "solid tube\n";
  for (const Triangle& t : Fans(mesh)) {
    text += " facet normal 0 0 0\n  outer loop\n";
    for (const std::uint32_t v : t) {
      const Point3& p = mesh.vertices[v];
      text += fmt::format("   vertex {} {} {}\n", p[0], p[1], p[2]);
    }
    text += "  endloop\n endfacet\n";
  }
  return text + "endsolid tube\n";
}

std::string StlBytesOf(const Polygons& mesh, std::string header) {
  const std::vector<Triangle> triangles = Fans(mesh);
  header.resize(80, ' ');
  header += BytesOf(static_cast<std::uint32_t>(triangles.size()));
  for (const Triangle& t : triangles) {
    header += BytesOf(0.0F) + BytesOf(0.0F) + BytesOf(1.0F);
    for (const std::uint32_t v : t) {
      for (const double x : mesh.vertices[v]) header += BytesOf(static_cast<float>(x));
    }
    header += BytesOf(std::uint16_t{0});
  }
  return header;
}

std::string PlyOf(const Polygons& mesh, std::string_view format) {
  std::string bytes = fmt::format(
      "ply\nformat {} 1.0\ncomment a tube\nelement vertex {}\nproperty double x\n"
      "property double y\nproperty double z\nelement face {}\n"
      "property list uchar int vertex_indices\nend_header\n",
      format, mesh.vertices.size(), mesh.faces.size());
  const bool text = format == "ascii", big = format == "binary_big_endian";
  for (const Point3& p : mesh.vertices) {
    if (text) bytes += fmt::format("{} {} {}\n", p[0], p[1], p[2]);
    if (!text) bytes += BytesOf(p[0], big) + BytesOf(p[1], big) + BytesOf(p[2], big);
  }
  for (const auto& face : mesh.faces) {
    const auto size = static_cast<std::uint8_t>(face.size());
    bytes += text ? fmt::format("{}", size) : BytesOf(size);
    for (const std::uint32_t v : face) bytes += text ? fmt::format(" {}", v) : BytesOf(v, big);
    if (text) bytes += '\n';
  }
  return bytes;
}

std::string GltfOf(const Polygons& mesh) {
  return GltfJson(
      mesh, R"(,"uri":"data:application/octet-stream;base64,)" + Base64(GltfBuffer(mesh)) + '"');
}

std::string GlbOf(const Polygons& mesh) { return GlbOf(GltfJson(mesh, ""), GltfBuffer(mesh)); }

std::string GlbOf(std::string json, std::string buffer) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  buffer.resize((buffer.size() + 3) / 4 * 4, '\0');
  const auto size = [](std::size_t bytes) { return BytesOf(static_cast<std::uint32_t>(bytes)); };
  const std::string chunks =
      size(json.size()) + "JSON" + json + size(buffer.size()) + std::string("BIN\0", 4) + buffer;
  return "glTF" + BytesOf(std::uint32_t{2}) + size(12 + chunks.size()) + chunks;
}

std::string Base64(std::string_view bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    const std::string_view three = bytes.substr(at, 3);
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      bits = bits << 8U | (k < three.size() ? static_cast<unsigned char>(three[k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= three.size() ? kDigits[bits >> (18 - 6 * k) & 63U] : '=';
    }
  }
  return text;
}

std::string Packed(std::string_view bytes) {
  z_stream stream{};
  deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
  std::string out(deflateBound(&stream, static_cast<uLong>(bytes.size())), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

std::vector<std::pair<std::string, std::string>> InEveryFormat(const Polygons& mesh) {
  std::vector<std::pair<std::string, std::string>> files{
      {"tube.obj", ObjOf(mesh)},
      {"tube.off", OffOf(mesh)},
      {"text.stl", StlTextOf(mesh)},
      {"bytes.stl", StlBytesOf(mesh)},
      {"solid.stl", StlBytesOf(mesh, "solid tube")},
      {"text.ply", PlyOf(mesh, "ascii")},
      {"little.ply", PlyOf(mesh, "binary_little_endian")},
      {"big.ply", PlyOf(mesh, "binary_big_endian")},
      {"tube.gltf", GltfOf(mesh)},
      {"tube.glb", GlbOf(mesh)},
  };
  const std::size_t count = files.size();
  for (std::size_t k = 0; k < count; ++k) {
    files.emplace_back(files[k].first + ".gz", Packed(files[k].second));
  }
  return files;
}

}  // namespace arap::testing
