#include "core/files/surface_file.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "core/files/polygon.h"

namespace arap {
namespace {

const SurfacePart* PartOf(const SurfaceFile& file, std::size_t face) {
  const auto next =
      std::upper_bound(file.parts.begin(), file.parts.end(), face,
                       [](std::size_t f, const SurfacePart& part) { return f < part.first_face; });
  return next == file.parts.begin() ? nullptr : &*std::prev(next);
}

// Counts faces of a kind, and is a warning about them in the end.
class FaceCounter {
 public:
  FaceCounter(SurfaceFile& file, const std::string& name) : file_(file), name_(name) {}

  void Add(std::size_t face) {
    if (warning_.elements.size() < Fault::kMaxElements) {
      warning_.elements.push_back(static_cast<std::uint32_t>(face));
    }
    ++warning_.count;
  }
  void Tell(std::string kind, std::string_view what) && {
    if (warning_.count == 0) return;
    warning_.kind = std::move(kind);
    warning_.message = fmt::format("{}: {} ({} in all)", file_.PlaceOf(name_, warning_.elements[0]),
                                   what, warning_.count);
    file_.warnings.push_back(std::move(warning_));
  }

 private:
  SurfaceFile& file_;
  const std::string& name_;
  Warning warning_;
};

}  // namespace

std::size_t SurfaceFile::FaceOf(std::size_t triangle) const {
  const auto next = std::upper_bound(first_triangle.begin(), first_triangle.end(), triangle);
  return static_cast<std::size_t>(next - first_triangle.begin()) - 1;
}

std::string_view SurfaceFile::ObjectOf(std::size_t face) const {
  const SurfacePart* const part = PartOf(*this, face);
  return part == nullptr ? std::string_view() : names[part->object];
}

std::string_view SurfaceFile::GroupOf(std::size_t face) const {
  const SurfacePart* const part = PartOf(*this, face);
  return part == nullptr ? std::string_view() : names[part->group];
}

std::size_t SurfaceFile::PlaceOf(std::size_t face) const {
  if (!face_lines.empty()) return face_lines[face];
  return face_numbers.empty() ? face : face_numbers[face];
}

std::string SurfaceFile::PlaceOf(const std::string& name, std::size_t face) const {
  return fmt::format("{}:{}{}", name, face_lines.empty() ? " face " : "", PlaceOf(face));
}

void SurfaceFile::BeginObject(std::string object) {
  SurfacePart& part = parts.emplace_back();
  part.first_face = static_cast<std::uint32_t>(face_count());
  if (object.empty()) return;
  std::replace_if(
      object.begin(), object.end(),
      [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; }, '_');
  part.object = static_cast<std::uint32_t>(names.size());
  names.push_back(std::move(object));
}

void SurfaceFile::EndFace(std::size_t line) {
  first_corner.push_back(static_cast<std::uint32_t>(corners.size()));
  if (line != 0) face_lines.push_back(static_cast<std::uint32_t>(line));
}

Status SurfaceFile::CutFaces(const std::string& name) {
  FaceCounter unclear(*this, name), repeated(*this, name);
  mesh.triangles.reserve(corners.size() - 2 * face_count());
  first_triangle.reserve(face_count() + 1);
  std::vector<std::uint32_t> distinct;
  for (std::size_t f = 0; f < face_count(); ++f) {
    std::span<const std::uint32_t> polygon = CornersOf(f);
    const auto twin = std::adjacent_find(polygon.begin(), polygon.end());
    if (polygon.size() > 3 && (twin != polygon.end() || polygon.front() == polygon.back())) {
      distinct.clear();
      std::unique_copy(polygon.begin(), polygon.end(), std::back_inserter(distinct));
      while (distinct.size() > 3 && distinct.front() == distinct.back()) distinct.pop_back();
      if (distinct.size() >= 3) {
        polygon = distinct;
        repeated.Add(f);
      }
    }
    switch (CutPolygon(mesh.vertices, polygon, mesh.triangles)) {
      case PolygonCut::kFan:
      case PolygonCut::kEars:
        break;
      case PolygonCut::kUnclear:
        unclear.Add(f);
        break;
      case PolygonCut::kTooLong:
        return Fail(FaultKind::kInvalidOption,
                    fmt::format("{}: the face is concave and has {} corners; the limit is {}",
                                PlaceOf(name, f), polygon.size(), kMaxConcaveCorners));
    }
    first_triangle.push_back(static_cast<std::uint32_t>(mesh.triangles.size()));
  }
  std::move(repeated).Tell("repeated_corners",
                           "a face names a corner twice in a row, which counts once");
  std::move(unclear).Tell("unclear_polygons",
                          "a face has no area or crosses itself and is cut from its first corner");
  return {};
}

}  // namespace arap
