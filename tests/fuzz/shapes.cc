#include "tests/fuzz/shapes.h"

namespace arap::fuzz {
namespace {

constexpr std::uint32_t kMaxSide = 6;

// nx × ny cells from vertex `first` on; a direction that is closed joins its end to its beginning,
// after a half twist if `twisted`.
struct Sheet {
  std::uint32_t nx = 1, ny = 1;
  bool around_x = false, around_y = false, twisted = false;

  std::uint32_t columns() const { return nx + (around_x ? 0 : 1); }
  std::uint32_t rows() const { return ny + (around_y ? 0 : 1); }
  std::uint32_t vertices() const { return columns() * rows(); }
  std::uint32_t Vertex(std::uint32_t i, std::uint32_t j) const {
    if (around_x && i >= nx) {
      i -= nx;
      if (twisted) j = rows() - 1 - j % rows();
    }
    return j % rows() * columns() + i;
  }
};

Sheet SheetFrom(Bytes& bytes, bool may_close) {
  const std::uint8_t kind = bytes.Byte();
  Sheet sheet;
  sheet.nx = 1 + bytes.Below(kMaxSide);
  sheet.ny = 1 + bytes.Below(kMaxSide);
  sheet.around_x = may_close && (kind & 1u) != 0;
  sheet.around_y = may_close && (kind & 2u) != 0;
  sheet.twisted = sheet.around_x && !sheet.around_y && (kind & 4u) != 0;
  return sheet;
}

void AddTriangles(const Sheet& sheet, std::uint32_t first, Bytes& bytes,
                  std::vector<Triangle>& triangles) {
  for (std::uint32_t j = 0; j < sheet.ny; ++j) {
    for (std::uint32_t i = 0; i < sheet.nx; ++i) {
      const std::uint32_t a = first + sheet.Vertex(i, j), b = first + sheet.Vertex(i + 1, j);
      const std::uint32_t c = first + sheet.Vertex(i + 1, j + 1),
                          d = first + sheet.Vertex(i, j + 1);
      if (bytes.Coin()) {
        triangles.push_back({a, b, c});
        triangles.push_back({a, c, d});
      } else {
        triangles.push_back({a, b, d});
        triangles.push_back({b, c, d});
      }
    }
  }
}

// Replaces a few indices, and leaves out or adds triangles.
void Damage(Bytes& bytes, std::size_t vertices, std::vector<Triangle>& triangles) {
  const auto anything = [&] {
    return bytes.Below(static_cast<std::uint32_t>(std::min<std::size_t>(vertices + 1, 256)));
  };
  for (std::uint32_t count = bytes.Below(4); count > 0; --count) {
    switch (bytes.Below(4)) {
      case 0:
        if (!triangles.empty())
          triangles[bytes.Byte() % triangles.size()][bytes.Below(3)] = anything();
        break;
      case 1:
        if (!triangles.empty())
          triangles.erase(triangles.begin() +
                          static_cast<std::ptrdiff_t>(bytes.Byte() % triangles.size()));
        break;
      case 2:
        triangles.push_back({anything(), anything(), anything()});
        break;
      default:
        if (!triangles.empty()) {
          Triangle& triangle = triangles[bytes.Byte() % triangles.size()];
          std::swap(triangle[0], triangle[1]);
        }
        break;
    }
  }
}

}  // namespace

PlanarMesh PlanarFrom(Bytes& bytes) {
  PlanarMesh mesh;
  for (std::uint32_t pieces = 1 + bytes.Below(3), piece = 0; piece < pieces; ++piece) {
    const Sheet sheet = SheetFrom(bytes, false);
    AddTriangles(sheet, static_cast<std::uint32_t>(mesh.vertices.size()), bytes, mesh.triangles);
    for (std::uint32_t v = 0; v < sheet.vertices(); ++v) {
      mesh.vertices.emplace_back(v % sheet.columns() + 10 * piece, v / sheet.columns());
    }
  }
  for (std::uint32_t moves = bytes.Below(16); moves > 0; --moves) {
    mesh.vertices[bytes.Byte() % mesh.vertices.size()] = {bytes.Number(), bytes.Number()};
  }
  Damage(bytes, mesh.vertices.size(), mesh.triangles);
  return mesh;
}

SurfaceMesh SurfaceFrom(Bytes& bytes) {
  SurfaceMesh mesh;
  for (std::uint32_t pieces = 1 + bytes.Below(2), piece = 0; piece < pieces; ++piece) {
    const Sheet sheet = SheetFrom(bytes, true);
    AddTriangles(sheet, static_cast<std::uint32_t>(mesh.vertices.size()), bytes, mesh.triangles);
    for (std::uint32_t v = 0; v < sheet.vertices(); ++v) {
      const double x = v % sheet.columns() + 10 * piece, y = v / sheet.columns();
      // A bump, so that closed sheets are not flat and open ones are not developable.
      mesh.vertices.push_back({x, y, 0.25 * x * y - 0.125 * x * x});
    }
  }
  for (std::uint32_t moves = bytes.Below(16); moves > 0; --moves) {
    mesh.vertices[bytes.Byte() % mesh.vertices.size()] = {bytes.Number(), bytes.Number(),
                                                          bytes.Number()};
  }
  Damage(bytes, mesh.vertices.size(), mesh.triangles);
  return mesh;
}

EnergyOptions EnergyFrom(Bytes& bytes, std::size_t triangles) {
  EnergyOptions options;
  options.basis = static_cast<Basis>(bytes.Below(4));
  options.weights = static_cast<Weights>(bytes.Below(2));
  const std::uint32_t rigid = bytes.Below(8);
  if (rigid >= 6) {
    options.rigidity.assign(triangles + (rigid == 7 ? bytes.Below(2) : 0), 1);
    for (std::uint32_t i = 0; i < 4 && !options.rigidity.empty(); ++i) {
      options.rigidity[bytes.Byte() % options.rigidity.size()] = bytes.Number();
    }
  }
  return options;
}

}  // namespace arap::fuzz
