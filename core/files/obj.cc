// Wavefront OBJ: the reader.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/base/try.h"
#include "core/files/formats.h"
#include "core/files/obj_statements.h"
#include "core/files/text_scan.h"

namespace arap {
namespace {

// How many there are of what may be named before it is there.
struct Counts {
  std::size_t vertices = 0, textures = 0, normals = 0, corners = 0, faces = 0;
};

Counts CountObj(std::string_view text) {
  Counts counts;
  ObjStatements statements(text);
  while (statements.Next()) {
    switch (statements.keyword()) {
      case ObjKeyword::kVertex:
        ++counts.vertices;
        break;
      case ObjKeyword::kTexture:
        ++counts.textures;
        break;
      case ObjKeyword::kNormal:
        ++counts.normals;
        break;
      case ObjKeyword::kFace:
        ++counts.faces;
        while (!statements.Argument().empty()) ++counts.corners;
        break;
      default:
        break;
    }
  }
  return counts;
}

// A warning about statements of a kind, which names the first one.
struct Noticed {
  std::size_t count = 0;
  std::size_t line = 0;
  std::string word;

  void Add(std::size_t at_line, std::string_view the_word) {
    if (count++ > 0) return;
    line = at_line;
    word = Quoted(the_word);
  }
};

// The object or the group that comes next.
struct PartName {
  std::string text;
  bool changed = false;
  std::uint32_t number = 0;  // in the file's list of names, unless it has changed

  void Set(std::string_view name) {
    text = name;
    changed = true;
  }
};

class ObjReader {
 public:
  ObjReader(SurfaceFile& file, const std::string& name)
      : file_(file), name_(name), all_(CountObj(file.text)), statements_(file.text) {}

  Status Read() {
    file_.mesh.vertices.reserve(all_.vertices);
    file_.corners.reserve(all_.corners);
    file_.first_corner.reserve(all_.faces + 1);
    file_.face_lines.reserve(all_.faces);
    while (statements_.Next()) CHECK_OK(ReadStatement());
    if (file_.face_count() == 0) {
      return Fail(FaultKind::kInvalidOption,
                  fmt::format("{}: no faces; {} vertices and {} unknown statements", name_,
                              all_.vertices, unknown_.count));
    }
    Tell(unknown_, "unknown_statements", "unknown statements are passed over");
    Tell(weights_, "vertex_weights", "weights of vertices other than 1 do not count");
    Tell(references_, "unknown_references",
         "corners name texture coordinates or normals that are not there");
    return file_.CutFaces(name_);
  }

 private:
  Status ReadStatement() {
    switch (statements_.keyword()) {
      case ObjKeyword::kVertex:
        return ReadVertex();
      case ObjKeyword::kTexture:
        ++so_far_.textures;
        break;
      case ObjKeyword::kNormal:
        ++so_far_.normals;
        break;
      case ObjKeyword::kFace:
        return ReadFace();
      case ObjKeyword::kObject:
        object_.Set(statements_.Name());
        named_ = true;
        break;
      case ObjKeyword::kGroup:
        group_.Set(statements_.Name());
        named_ = true;
        break;
      case ObjKeyword::kUnknown:
        unknown_.Add(statements_.line(), statements_.word());
        break;
      case ObjKeyword::kLine:
      case ObjKeyword::kOther:
        break;
    }
    return {};
  }

  auto Bad(std::string_view what) const { return FailAt(name_, statements_.line(), what); }

  // The same with the place.
  template <class Value>
  Result<Value> Placed(Result<Value> read) const {
    if (!read) return Bad(read.error().message);
    return read;
  }

  Status ReadVertex() {
    const std::size_t line = statements_.line();
    std::array<double, 7> numbers{};
    std::size_t count = 0;
    for (std::string_view word; !(word = statements_.Argument()).empty(); ++count) {
      if (count == numbers.size()) {
        return Bad(fmt::format("{}: a vertex has two to four numbers, and up to four of a colour",
                               Quoted(word)));
      }
      TRY(numbers[count], Placed(ParseNumber(word)));
      if (count == 3) weight_word_ = word;
    }
    if (count < 2 || count == 5) {
      return FailAt(name_, line,
                    fmt::format("'{}' with {} numbers: a vertex has two to four numbers, and three "
                                "or four more of a colour",
                                statements_.word(), count));
    }
    if (count == 4 && numbers[3] != 1) weights_.Add(statements_.line(), weight_word_);
    file_.mesh.vertices.push_back({numbers[0], numbers[1], numbers[2]});
    return {};
  }

  Status ReadFace() {
    const std::size_t line = statements_.line();
    const std::size_t first = file_.corners.size();
    if (std::exchange(named_, false)) BeginPart();
    for (std::string_view word; !(word = statements_.Argument()).empty();) {
      TRY(const std::uint32_t corner, ReadCorner(word));
      file_.corners.push_back(corner);
    }
    const std::size_t count = file_.corners.size() - first;
    if (count < 3) {
      return FailAt(
          name_, line,
          fmt::format("'{}' with {} corners: a face has three or more", statements_.word(), count));
    }
    file_.EndFace(line);
    return {};
  }

  // A corner is a, a/b, a//c or a/b/c: the indices of a vertex, a texture coordinate and a normal.
  Result<std::uint32_t> ReadCorner(std::string_view word) {
    std::array<std::string_view, 3> parts;
    std::string_view rest = word;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const std::size_t slash = rest.find('/');
      parts[i] = rest.substr(0, slash);
      rest = slash == std::string_view::npos ? std::string_view() : rest.substr(slash + 1);
    }
    if (!rest.empty()) {
      return Bad(fmt::format("{} is no corner: it has more than three indices", Quoted(word)));
    }
    for (std::size_t i = 1; i < parts.size(); ++i) {
      if (parts[i].empty()) continue;
      TRY(const std::int64_t index, Index(word, parts[i]));
      const std::size_t all = i == 1 ? all_.textures : all_.normals;
      const std::size_t so_far = i == 1 ? so_far_.textures : so_far_.normals;
      if (!Resolved(index, so_far, all)) references_.Add(statements_.line(), word);
    }
    TRY(const std::int64_t index, Index(word, parts[0]));
    if (index == 0) {
      return Bad(fmt::format("{}: there is no vertex 0, they count from 1", Quoted(word)));
    }
    const auto vertex = Resolved(index, file_.mesh.vertices.size(), all_.vertices);
    if (vertex) return *vertex;
    if (index > 0) {
      return Bad(fmt::format("{}: there is no vertex {}, the file has {}", Quoted(word), index,
                             all_.vertices));
    }
    return Bad(fmt::format("{}: there is no vertex {}, the file has {} up to here", Quoted(word),
                           index, file_.mesh.vertices.size()));
  }

  Result<std::int64_t> Index(std::string_view word, std::string_view part) const {
    Result<std::int64_t> index = ParseWhole(part);
    if (!index) return Bad(fmt::format("{} is no corner: {}", Quoted(word), index.error().message));
    return index;
  }

  // Counted from 0; nothing when it is not there.
  static std::optional<std::uint32_t> Resolved(std::int64_t index, std::size_t so_far,
                                               std::size_t all) {
    const auto counted = static_cast<std::int64_t>(so_far);
    const std::int64_t place = index < 0 ? counted + index : index - 1;
    if (place < 0 || place >= static_cast<std::int64_t>(all)) return std::nullopt;
    return static_cast<std::uint32_t>(place);
  }

  void BeginPart() {
    SurfacePart& part = file_.parts.emplace_back();
    part.first_face = static_cast<std::uint32_t>(file_.face_count());
    part.object = NumberOf(object_);
    part.group = NumberOf(group_);
  }

  // The number of a name in the file's list. Only names that faces have get there.
  std::uint32_t NumberOf(PartName& name) {
    if (!std::exchange(name.changed, false) || file_.names[name.number] == name.text) {
      return name.number;
    }
    name.number = 0;
    if (name.text.empty()) return name.number;
    name.number = static_cast<std::uint32_t>(file_.names.size());
    file_.names.push_back(name.text);
    return name.number;
  }

  void Tell(const Noticed& noticed, std::string kind, std::string_view what) {
    if (noticed.count == 0) return;
    Warning& warning = file_.warnings.emplace_back();
    warning.kind = std::move(kind);
    warning.count = noticed.count;
    warning.message = fmt::format("{}:{}: {}, the first is {} ({} in all)", name_, noticed.line,
                                  what, noticed.word, noticed.count);
  }

  SurfaceFile& file_;
  const std::string& name_;
  const Counts all_;
  Counts so_far_;
  ObjStatements statements_;
  PartName object_, group_;
  bool named_ = false;  // since the last face
  std::string_view weight_word_;
  Noticed unknown_, weights_, references_;
};

}  // namespace

Result<SurfaceFile> ParseObj(std::string text, const std::string& name) {
  CHECK_OK(CheckText(text, name));
  SurfaceFile file;
  file.text = std::move(text);
  CHECK_OK(ObjReader(file, name).Read());
  return file;
}

}  // namespace arap
