// glTF 2.0: the surface of all meshes of its scene.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/base/try.h"
#include "core/files/formats.h"

namespace arap {
namespace {

// A place in space: three rows of a linear part and a shift.
using Affine = std::array<std::array<double, 4>, 3>;
constexpr Affine kStay{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

Affine Product(const Affine& a, const Affine& b) {
  Affine c{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      c[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j] + (j == 3 ? a[i][3] : 0);
    }
  }
  return c;
}

Point3 Image(const Affine& a, const Point3& p) {
  Point3 q{};
  for (std::size_t i = 0; i < 3; ++i) {
    q[i] = a[i][0] * p[0] + a[i][1] * p[1] + a[i][2] * p[2] + a[i][3];
  }
  return q;
}

bool IsMirrored(const Affine& a) {
  return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) -
             a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
             a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]) <
         0;
}

// The numbers of a member, or `numbers` as they are where it is missing.
template <std::size_t kCount>
Status ReadNumbers(const GltfValue& value, const char* member,
                   std::array<double, kCount>& numbers) {
  const auto list = value.Find(member);
  if (!list) return {};
  if (list->size() != kCount) return list->Bad(fmt::format("not a list of {} numbers", kCount));
  for (std::size_t k = 0; k < kCount; ++k) {
    TRY(numbers[k], list->At(k).Number());
  }
  return {};
}

// Where a node stands in its parent.
Result<Affine> LocalPlace(const GltfValue& node) {
  if (const auto matrix = node.Find("matrix")) {
    std::array<double, 16> columns{};
    CHECK_OK(ReadNumbers(node, "matrix", columns));
    if (columns[3] != 0 || columns[7] != 0 || columns[11] != 0 || columns[15] != 1) {
      return matrix->Bad("the last row is not 0 0 0 1");
    }
    Affine place{};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 4; ++j) place[i][j] = columns[4 * j + i];
    }
    return place;
  }
  std::array<double, 3> shift{}, scale{1, 1, 1};
  std::array<double, 4> turn{0, 0, 0, 1};
  CHECK_OK(ReadNumbers(node, "translation", shift));
  CHECK_OK(ReadNumbers(node, "rotation", turn));
  CHECK_OK(ReadNumbers(node, "scale", scale));
  const auto [x, y, z, w] = turn;
  const double squared = x * x + y * y + z * z + w * w;
  if (!(squared > 0) || !std::isfinite(squared)) return node.Bad("the rotation is no quaternion");
  const double s = 2 / squared;
  const std::array<std::array<double, 3>, 3> turned{
      {{1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)},
       {s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w)},
       {s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y)}}};
  Affine place{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) place[i][j] = turned[i][j] * scale[j];
    place[i][3] = shift[i];
  }
  return place;
}

// Whether a file may require this extension: it leaves the shape as it is without, or is read.
bool IsKnown(std::string_view extension) {
  constexpr std::array<std::string_view, 10> kKnown{
      "KHR_mesh_quantization", "KHR_materials_", "KHR_texture_",
      "KHR_lights_",           "KHR_xmp",        "KHR_animation_pointer",
      "EXT_texture_",          "EXT_lights_",    "MSFT_texture_",
      "ADOBE_materials_"};
  return std::any_of(kKnown.begin(), kKnown.end(),
                     [extension](std::string_view each) { return extension.starts_with(each); });
}

class GltfReader {
 public:
  GltfReader(std::string_view bytes, const std::string& name, const LoadBeside& load)
      : name_(name), document_(bytes, name, load) {}

  Result<SurfaceFile> Read() {
    CHECK_OK(document_.Open());
    CHECK_OK(CheckExtensions());
    CHECK_OK(WalkScene());
    Tell(skipped_, "points_and_lines", "points and lines are passed over");
    Tell(morphed_, "morph_targets", "morph targets are passed over");
    Tell(skinned_, "skins", "skins are passed over, and the meshes are as they were modelled");
    const auto meshes = document_.root().Find("meshes");
    Tell((meshes ? meshes->size() : 0) - shown_.size(), "hidden_meshes",
         "meshes that the scene does not show are passed over");
    if (file_.face_count() == 0) {
      return Fail(FaultKind::kInvalidOption,
                  fmt::format("{}: the scene shows no triangles; {} parts are points or lines",
                              name_, skipped_));
    }
    CHECK_OK(file_.CutFaces(name_));
    return std::move(file_);
  }

 private:
  struct Visit {
    std::size_t node;
    Affine place;  // of its parent
  };

  void Tell(std::size_t count, const char* kind, const char* what) {
    if (count == 0) return;
    Warning& warning = file_.warnings.emplace_back();
    warning.kind = kind;
    warning.count = count;
    warning.message = fmt::format("{}: {} ({} in all)", name_, what, count);
  }

  Status CheckExtensions() const {
    const auto required = document_.root().Find("extensionsRequired");
    for (std::size_t k = 0; required && k < required->size(); ++k) {
      const GltfValue extension = required->At(k);
      if (!IsKnown(extension.Text())) {
        return extension.Bad(fmt::format("'{}' is not read", extension.Text()));
      }
    }
    return {};
  }

  // Depth first, in the order of the file. No node is passed twice, so it comes to an end.
  Status WalkScene() {
    const auto nodes = document_.root().Find("nodes");
    if (!nodes) return {};
    seen_.assign(nodes->size(), false);
    CHECK_OK(PushRoots(*nodes));
    while (!visits_.empty()) {
      const Visit visit = visits_.back();
      visits_.pop_back();
      const GltfValue node = nodes->At(visit.node);
      if (seen_[visit.node]) return node.Bad("it has two parents, or is above itself");
      seen_[visit.node] = true;
      TRY(const Affine local, LocalPlace(node));
      const Affine place = Product(visit.place, local);
      if (const auto mesh = node.Find("mesh")) CHECK_OK(AddMesh(node, *mesh, place));
      if (const auto children = node.Find("children")) CHECK_OK(Push(*children, place));
    }
    return {};
  }

  // The list is one of numbers of nodes.
  Status Push(const GltfValue& list, const Affine& place) {
    const std::size_t first = visits_.size();
    for (std::size_t k = 0; k < list.size(); ++k) {
      CHECK_OK(document_.Get("nodes", list.At(k)));
      TRY(const std::size_t node, list.At(k).Whole());
      visits_.push_back({node, place});
    }
    std::reverse(visits_.begin() + static_cast<std::ptrdiff_t>(first), visits_.end());
    return {};
  }

  Status PushRoots(const GltfValue& nodes) {
    const auto scenes = document_.root().Find("scenes");
    if (const auto opened = document_.root().Find("scene")) {
      TRY(const GltfValue scene, document_.Get("scenes", *opened));
      const auto roots = scene.Find("nodes");
      return roots ? Push(*roots, kStay) : Status();
    }
    if (scenes && scenes->size() > 0) {
      const auto roots = scenes->At(0).Find("nodes");
      return roots ? Push(*roots, kStay) : Status();
    }
    std::vector<bool> is_child(nodes.size());
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const auto children = nodes.At(n).Find("children");
      for (std::size_t k = 0; children && k < children->size(); ++k) {
        CHECK_OK(document_.Get("nodes", children->At(k)));
        TRY(const std::size_t child, children->At(k).Whole());
        is_child[child] = true;
      }
    }
    for (std::size_t n = nodes.size(); n-- > 0;) {
      if (!is_child[n]) visits_.push_back({n, kStay});
    }
    return {};
  }

  Status AddMesh(const GltfValue& node, const GltfValue& index, const Affine& place) {
    TRY(const GltfValue mesh, document_.Get("meshes", index));
    TRY(const std::size_t number, index.Whole());
    shown_.insert(number);
    if (const auto extensions = node.Find("extensions")) {
      if (const auto instances = extensions->Find("EXT_mesh_gpu_instancing")) {
        return instances->Bad("instances are not read");
      }
    }
    const bool skinned = node.Find("skin").has_value();
    if (skinned) ++skinned_;
    const auto primitives = mesh.Find("primitives");
    if (!primitives) return mesh.Bad("'primitives' is missing");
    const std::string_view node_name = node.Text("name");
    const std::string_view object = node_name.empty() ? mesh.Text("name") : node_name;
    std::map<std::size_t, std::size_t> first_vertices;  // by accessor
    bool begun = false;
    for (std::size_t k = 0; k < primitives->size(); ++k) {
      TRY(const bool triangles,
          AddPrimitive(primitives->At(k), skinned ? kStay : place, first_vertices,
                       begun ? std::nullopt : std::optional(object)));
      begun = begun || triangles;
    }
    return {};
  }

  // Whether it has triangles. Before the first ones of an object it is told what that is.
  Result<bool> AddPrimitive(const GltfValue& primitive, const Affine& place,
                            std::map<std::size_t, std::size_t>& first_vertices,
                            std::optional<std::string_view> object) {
    constexpr std::size_t kTriangles = 4, kStrip = 5, kFan = 6;
    TRY(const std::size_t mode, primitive.Whole("mode", kTriangles));
    if (mode == kStrip || mode == kFan) return primitive.Bad("strips and fans are not read");
    if (mode > kFan) return primitive.Bad(fmt::format("there is no mode {}", mode));
    if (mode < kTriangles) {
      ++skipped_;
      return false;
    }
    if (primitive.Find("targets")) ++morphed_;
    const auto attributes = primitive.Find("attributes");
    const auto position = attributes ? attributes->Find("POSITION") : std::nullopt;
    if (!position) return primitive.Bad("the POSITION of the vertices is missing");
    for (const char* more : {"NORMAL", "TEXCOORD_0", "COLOR_0", "TANGENT"}) {
      file_.has_extras = file_.has_extras || attributes->Find(more);
    }
    TRY(const GltfArray positions, document_.ArrayOf(*position, 3));
    if (positions.component == kGltfUint32) {
      return position->Bad("positions have to be floats or short whole numbers");
    }
    const auto indices = primitive.Find("indices");
    GltfArray corners;
    if (indices) {
      TRY(corners, document_.ArrayOf(*indices, 1));
      const bool whole = corners.component == kGltfUint8 || corners.component == kGltfUint16 ||
                         corners.component == kGltfUint32;
      if (!whole || corners.normalized) return indices->Bad("indices have to be unsigned");
    }
    const std::size_t count = indices ? corners.count : positions.count;
    if (count % 3 != 0) {
      return primitive.Bad(fmt::format("{} corners are no whole number of triangles", count));
    }
    TRY(const std::size_t accessor, position->Whole());
    const auto known = first_vertices.find(accessor);
    const bool fresh = known == first_vertices.end();
    CHECK_OK(CheckRoom(fresh ? positions.count : 0, count / 3, object.value_or("").size()));
    const std::size_t first = fresh ? file_.mesh.vertices.size() : known->second;
    if (fresh) {
      first_vertices.emplace(accessor, first);
      CHECK_OK(AddVertices(*position, positions, place));
    }
    if (count == 0) return false;
    if (object) file_.BeginObject(std::string(*object));
    const bool mirrored = IsMirrored(place);
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t vertex = indices ? static_cast<std::size_t>(corners.At(k)) : k;
      if (vertex >= positions.count) {
        return indices->Bad(
            fmt::format("entry {} is vertex {}, there are {}", k, vertex, positions.count));
      }
      file_.corners.push_back(static_cast<std::uint32_t>(first + vertex));
      if (k % 3 != 2) continue;
      if (mirrored) std::swap(file_.corners.end()[-1], file_.corners.end()[-2]);
      file_.EndFace();
    }
    return true;
  }

  // Many nodes may show one mesh, and many parts have the same indices, so that few bytes make many
  // triangles.
  Status CheckRoom(std::size_t vertices, std::size_t triangles, std::size_t name_size) {
    constexpr std::size_t kAlways = std::size_t{4} << 20U, kForEachByte = 10;
    constexpr std::size_t kVertex = sizeof(Point3), kTriangle = 32;
    taken_ += vertices * kVertex + triangles * kTriangle + name_size;
    if (taken_ <= kAlways + kForEachByte * document_.size()) return {};
    return Fail(FaultKind::kInvalidOption,
                fmt::format("{}: its nodes repeat meshes to {} vertices and {} triangles and more, "
                            "which is too much for a file of {} bytes",
                            name_, file_.mesh.vertices.size() + vertices,
                            file_.face_count() + triangles, document_.size()));
  }

  Status AddVertices(const GltfValue& accessor, const GltfArray& positions, const Affine& place) {
    for (std::size_t v = 0; v < positions.count; ++v) {
      Point3 point{};
      for (std::size_t k = 0; k < 3; ++k) point[k] = positions.At(v, k);
      if (place != kStay) point = Image(place, point);  // else every bit stays
      for (const double x : point) {
        if (!std::isfinite(x)) {
          return accessor.Bad(fmt::format("vertex {} is not finite where its node puts it", v));
        }
      }
      file_.mesh.vertices.push_back(point);
    }
    return {};
  }

  const std::string& name_;
  GltfDocument document_;
  SurfaceFile file_;
  std::vector<bool> seen_;  // by node
  std::vector<Visit> visits_;
  std::set<std::size_t> shown_;  // meshes
  std::size_t taken_ = 0;
  std::size_t skipped_ = 0, morphed_ = 0, skinned_ = 0;
};

}  // namespace

Result<SurfaceFile> ParseGltf(std::string_view bytes, const std::string& name,
                              const LoadBeside& load) {
  return GltfReader(bytes, name, load).Read();
}

}  // namespace arap
