#include "core/files/mesh_file.h"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <filesystem>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "core/base/try.h"
#include "core/files/off.h"
#include "core/files/plane_fit.h"

namespace arap {
namespace {

std::string EndingOf(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

}  // namespace

Result<SurfaceFile> ReadSurfaceFile(const std::string& path) {
  if (path == kStandardStream) {
    TRY(std::string text, ReadBytes(path));
    const bool off = WithoutByteOrderMark(text).substr(0, 3) == "OFF";
    return off ? ParseOff(text, path) : ParseObj(std::move(text), path);
  }
  const std::string ending = EndingOf(path);
  if (ending != ".obj" && ending != ".off") {
    return Fail(FaultKind::kInvalidOption,
                path + ": not a mesh file: the name ends neither in .obj nor in .off");
  }
  TRY(std::string text, ReadBytes(path));
  return ending == ".obj" ? ParseObj(std::move(text), path) : ParseOff(text, path);
}

Result<SurfaceMesh> ReadSurfaceMesh(const std::string& path) {
  TRY(SurfaceFile file, ReadSurfaceFile(path));
  return std::move(file.mesh);
}

Result<PlanarMesh> ReadPlanarMesh(const std::string& path, std::vector<Warning>* notes) {
  TRY(SurfaceFile file, ReadSurfaceFile(path));
  if (notes != nullptr) {
    std::move(file.warnings.begin(), file.warnings.end(), std::back_inserter(*notes));
  }
  auto fit = FitPlane(std::move(file.mesh));
  if (!fit) {
    fit.error().message = path + ": " + fit.error().message;
    return Fail(std::move(fit.error()));
  }
  if (notes != nullptr) notes->insert(notes->end(), fit->notes.begin(), fit->notes.end());
  return std::move(fit->mesh);
}

ShapesFile::ShapesFile(const std::string& path, std::size_t vertex_count) : file_(path) {
  std::string header = "frame";
  for (std::size_t v = 0; v < vertex_count; ++v) {
    fmt::format_to(std::back_inserter(header), ",x{0},y{0}", v);
  }
  (void)file_.Write(header + '\n');
}

Status ShapesFile::Write(std::size_t frame, std::span<const Complex> positions) {
  std::string row = fmt::format("{}", frame);
  for (const Complex p : positions) {
    fmt::format_to(std::back_inserter(row), ",{},{}", p.real(), p.imag());
  }
  return file_.Write(row + '\n');
}

}  // namespace arap
