#include "core/files/mesh_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/base/try.h"
#include "core/files/bytes.h"
#include "core/files/formats.h"
#include "core/files/plane_fit.h"
#include "core/files/text_scan.h"

namespace arap {
namespace {

enum class MeshFormat : std::uint8_t { kObj, kOff, kStl, kPly, kGltf };

struct MeshEnding {
  std::string_view ending;
  MeshFormat format;
  const char* name;
};

// The first one of a format has its name.
constexpr std::array<MeshEnding, 6> kMeshEndings{{{".obj", MeshFormat::kObj, "OBJ"},
                                                  {".off", MeshFormat::kOff, "OFF"},
                                                  {".stl", MeshFormat::kStl, "STL"},
                                                  {".ply", MeshFormat::kPly, "PLY"},
                                                  {".gltf", MeshFormat::kGltf, "glTF"},
                                                  {".glb", MeshFormat::kGltf, "glTF"}}};

// ".gz" alone says nothing.
std::optional<MeshFormat> FormatOfName(const std::string& path) {
  constexpr std::string_view kPacked = ".gz";
  std::string lower(path);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (lower.ends_with(kPacked)) lower.resize(lower.size() - kPacked.size());
  for (const MeshEnding& each : kMeshEndings) {
    if (lower.ends_with(each.ending)) return each.format;
  }
  return std::nullopt;
}

// OBJ files, and OFF files without their keyword, begin with anything.
std::optional<MeshFormat> FormatOfContent(std::string_view bytes) {
  if (IsBinaryStl(bytes)) return MeshFormat::kStl;
  std::string word(TextScanner(bytes).NextWord().substr(0, 12));
  if (word.starts_with("glTF") || word.starts_with('{')) return MeshFormat::kGltf;
  if (word == "ply") return MeshFormat::kPly;
  std::transform(word.begin(), word.end(), word.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  if (word == "SOLID") return MeshFormat::kStl;
  // As in COFF and OFF15: the counts may be glued to it.
  const std::size_t off = word.find("OFF");
  const bool is_off = off != std::string::npos &&
                      word.substr(0, off).find_first_not_of("STCN4") == std::string::npos;
  return is_off ? std::optional(MeshFormat::kOff) : std::nullopt;
}

// What a glTF file at `path` names beside it.
Result<std::string> ReadBeside(const std::string& path, const std::string& name,
                               std::size_t least) {
  const std::string beside = (std::filesystem::path(path).parent_path() / name).string();
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(beside, error);  // of a regular file
  if (error) return Fail(FaultKind::kNotFound, fmt::format("{}: {}", beside, error.message()));
  if (size < least || size >> 32U != 0) {
    return Fail(FaultKind::kInvalidOption,
                fmt::format("{}: {} wants {} bytes of it, it has {}; the limit is 4 GiB", beside,
                            path, least, size));
  }
  return ReadBytes(beside);
}

Result<SurfaceFile> ParseMesh(MeshFormat format, std::string bytes, const std::string& path) {
  switch (format) {
    case MeshFormat::kObj:
      return ParseObj(std::move(bytes), path);
    case MeshFormat::kOff:
      return ParseOff(bytes, path);
    case MeshFormat::kStl:
      return ParseStl(bytes, path);
    case MeshFormat::kPly:
      return ParsePly(bytes, path);
    case MeshFormat::kGltf:
      break;
  }
  return ParseGltf(bytes, path, [&path](const std::string& name, std::size_t least) {
    return ReadBeside(path, name, least);
  });
}

}  // namespace

Result<SurfaceFile> ReadSurfaceFile(const std::string& path) {
  TRY(std::string bytes, ReadBytes(path));
  if (IsGzip(bytes)) {
    TRY(bytes, Unpack(bytes, path));
    if (IsGzip(bytes)) return Fail(FaultKind::kInvalidOption, path + ": packed twice by gzip");
  }
  const auto named = FormatOfName(path), shown = FormatOfContent(bytes);
  if (!named && !shown && path != kStandardStream) {
    return Fail(
        FaultKind::kInvalidOption,
        path +
            ": not a mesh file: the name ends with none of .obj, .off, .stl, .ply, .gltf and "
            ".glb (or these and .gz), and the content is that of none");
  }
  const MeshFormat format = shown ? *shown : named.value_or(MeshFormat::kObj);
  TRY(SurfaceFile file, ParseMesh(format, std::move(bytes), path));
  if (named && named != format) {
    const auto ending =
        std::find_if(kMeshEndings.begin(), kMeshEndings.end(),
                     [format](const MeshEnding& each) { return each.format == format; });
    Warning warning;
    warning.kind = "other_format";
    warning.count = 1;
    warning.message =
        fmt::format("{}: the content is {}, whatever the name says", path, ending->name);
    file.warnings.insert(file.warnings.begin(), std::move(warning));
  }
  return file;
}

Result<SurfaceMesh> ReadSurfaceMesh(const std::string& path) {
  TRY(SurfaceFile file, ReadSurfaceFile(path));
  return std::move(file.mesh);
}

Result<PlanarMesh> ReadPlanarMesh(const std::string& path) {
  TRY(SurfaceMesh mesh, ReadSurfaceMesh(path));
  auto fit = FitPlane(std::move(mesh));
  if (!fit) {
    fit.error().message = path + ": " + fit.error().message;
    return Fail(std::move(fit.error()));
  }
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
