#include "core/files/obj_writer.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/base/plane.h"
#include "core/files/obj_statements.h"

namespace arap {
namespace {

void AppendVertices(std::span<const Point3> vertices, std::string& out) {
  for (const Point3& p : vertices) {
    fmt::format_to(std::back_inserter(out), "v {} {} {}\n", p[0], p[1], p[2]);
  }
}

void AppendFaces(std::span<const Triangle> triangles, std::string& out) {
  for (const Triangle& t : triangles) {
    fmt::format_to(std::back_inserter(out), "f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  }
}

// A backslash could join lines here.
void AppendName(std::string name, std::string& out) {
  std::replace(name.begin(), name.end(), '\\', '_');
  out += "o " + name + '\n';
}

std::string_view LineEndOf(std::string_view text) {
  const std::size_t end = text.find_first_of("\r\n");
  if (end == std::string_view::npos || text[end] == '\n') return "\n";
  return text.substr(end).starts_with("\r\n") ? "\r\n" : "\r";
}

// A corner as the text has it: the vertex before the first slash, the normal behind the second.
struct CornerText {
  std::string_view vertex, normal;

  explicit CornerText(std::string_view word) : vertex(word.substr(0, word.find('/'))) {
    const std::size_t last = word.rfind('/');
    if (last != std::string_view::npos && last > vertex.size()) normal = word.substr(last + 1);
  }
  void Append(std::uint32_t uv, std::string& out) const {
    fmt::format_to(std::back_inserter(out), "{}/{}", vertex, uv + 1);
    if (!normal.empty()) fmt::format_to(std::back_inserter(out), "/{}", normal);
  }
};

class LayoutWriter {
 public:
  // `text` is one of the surface, and outlives this.
  LayoutWriter(const SurfaceFile& file, std::string_view text, std::span<const Complex> uv,
               std::span<const Triangle> corner_uv)
      : file_(file),
        text_(text),
        uv_(uv),
        corner_uv_(corner_uv),
        end_(LineEndOf(text_)),
        statements_(text_) {}

  std::string Write() {
    while (statements_.Next()) {
      switch (statements_.keyword()) {
        case ObjKeyword::kTexture:
          WriteLayout();
          DropStatement();
          break;
        case ObjKeyword::kFace:
          WriteLayout();
          WriteFace();
          ++face_;
          break;
        case ObjKeyword::kLine:
          WriteLine();
          break;
        default:
          break;
      }
    }
    KeepUpTo(text_.size());
    return std::move(out_);
  }

  const std::vector<std::uint32_t>& split_faces() const { return split_faces_; }

 private:
  void KeepUpTo(std::size_t offset) {
    if (offset <= kept_) return;
    out_ += text_.substr(kept_, offset - kept_);
    kept_ = offset;
  }

  void WriteLayout() {
    if (std::exchange(written_, true)) return;
    KeepUpTo(statements_.line_begin());
    for (const Complex p : uv_) {
      fmt::format_to(std::back_inserter(out_), "vt {} {}{}", p.real(), p.imag(), end_);
    }
  }

  // With its line when there is nothing else on it.
  void DropStatement() {
    const bool first = statements_.leads_line();
    while (!statements_.Argument().empty()) {
    }
    std::size_t end = std::min(text_.find_first_not_of(" \t", statements_.at()), text_.size());
    const bool alone = first && (end == text_.size() || text_[end] == '\n' || text_[end] == '\r');
    KeepUpTo(alone ? statements_.line_begin() : statements_.begin());
    if (!alone) {
      end = statements_.at();
    } else if (end < text_.size()) {
      end += text_.substr(end).starts_with("\r\n") ? std::size_t{2} : std::size_t{1};
    }
    kept_ = end;
  }

  void WriteLine() {
    for (std::string_view word; !(word = statements_.Argument()).empty();) {
      const std::size_t begin = statements_.at() - word.size();
      KeepUpTo(begin + CornerText(word).vertex.size());
      kept_ = statements_.at();
    }
  }

  void WriteFace() {
    const std::size_t first = file_.first_triangle[face_], end = file_.first_triangle[face_ + 1];
    const std::span<const std::uint32_t> corners = file_.CornersOf(face_);
    if (corners.size() > 3 && !FindPlaces(first, end)) return WriteTriangles(first, end);
    std::size_t k = 0;
    for (std::string_view word; !(word = statements_.Argument()).empty(); ++k) {
      KeepUpTo(statements_.at() - word.size());
      const std::uint32_t uv = corners.size() == 3 ? corner_uv_[first][k] : PlaceOf(corners[k]);
      CornerText(word).Append(uv, out_);
      kept_ = statements_.at();
    }
  }

  // Where the vertices of these triangles lie; false when one of them lies in several places.
  bool FindPlaces(std::size_t first, std::size_t end) {
    places_.clear();
    for (std::size_t t = first; t < end; ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        places_.emplace_back(file_.mesh.triangles[t][k], corner_uv_[t][k]);
      }
    }
    std::sort(places_.begin(), places_.end());
    places_.erase(std::unique(places_.begin(), places_.end()), places_.end());
    return std::adjacent_find(places_.begin(), places_.end(), [](const auto& a, const auto& b) {
             return a.first == b.first;
           }) == places_.end();
  }
  // By FindPlaces.
  std::uint32_t PlaceOf(std::uint32_t vertex) const {
    return std::lower_bound(places_.begin(), places_.end(), std::pair(vertex, std::uint32_t{0}))
        ->second;
  }

  // The face as a statement for each triangle.
  void WriteTriangles(std::size_t first, std::size_t end) {
    split_faces_.push_back(static_cast<std::uint32_t>(face_));
    KeepUpTo(statements_.begin());
    std::vector<std::pair<std::uint32_t, CornerText>> words;
    const std::span<const std::uint32_t> corners = file_.CornersOf(face_);
    for (std::string_view word; !(word = statements_.Argument()).empty();) {
      words.emplace_back(corners[words.size()], CornerText(word));
    }
    const auto before = [](const auto& a, const auto& b) { return a.first < b.first; };
    std::stable_sort(words.begin(), words.end(), before);
    for (std::size_t t = first; t < end; ++t) {
      if (t > first) out_ += end_;
      out_ += 'f';
      for (std::size_t k = 0; k < 3; ++k) {
        const auto word = std::lower_bound(
            words.begin(), words.end(), file_.mesh.triangles[t][k],
            [](const auto& one, std::uint32_t vertex) { return one.first < vertex; });
        out_ += ' ';
        word->second.Append(corner_uv_[t][k], out_);
      }
    }
    kept_ = statements_.at();
  }

  const SurfaceFile& file_;
  std::string_view text_;
  std::span<const Complex> uv_;
  std::span<const Triangle> corner_uv_;
  std::string_view end_;  // of lines
  ObjStatements statements_;
  std::string out_;
  std::size_t kept_ = 0;  // the text before it is in `out_`, as far as it is kept
  std::size_t face_ = 0;
  bool written_ = false;                                         // the layout is
  std::vector<std::pair<std::uint32_t, std::uint32_t>> places_;  // vertices with flat positions
  std::vector<std::uint32_t> split_faces_;
};

}  // namespace

std::string FormatObj(const PlanarMesh& mesh) {
  std::string out;
  for (const Complex p : mesh.vertices) {
    fmt::format_to(std::back_inserter(out), "v {} {} 0\n", p.real(), p.imag());
  }
  AppendFaces(mesh.triangles, out);
  return out;
}

std::string FormatObj(const SurfaceMesh& mesh) {
  std::string out;
  AppendVertices(mesh.vertices, out);
  AppendFaces(mesh.triangles, out);
  return out;
}

std::string FormatObj(const SurfaceFile& file) {
  std::string out;
  AppendVertices(file.mesh.vertices, out);
  auto part = file.parts.begin();
  for (std::size_t f = 0; f < file.face_count(); ++f) {
    // Several may begin at one face; the last one counts.
    for (; part != file.parts.end() && part->first_face <= f; ++part) {
      if (file.names.size() > 1) AppendName(file.names[part->object], out);
    }
    out += 'f';
    for (const std::uint32_t corner : file.CornersOf(f)) {
      fmt::format_to(std::back_inserter(out), " {}", std::uint64_t{corner} + 1);
    }
    out += '\n';
  }
  return out;
}

std::string FormatObj(const SurfaceMesh& mesh, std::span<const Complex> uv,
                      std::span<const Triangle> corner_uv) {
  std::string out;
  AppendVertices(mesh.vertices, out);
  for (const Complex p : uv) {
    fmt::format_to(std::back_inserter(out), "vt {} {}\n", p.real(), p.imag());
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle &v = mesh.triangles[t], &u = corner_uv[t];
    fmt::format_to(std::back_inserter(out), "f {}/{} {}/{} {}/{}\n", v[0] + 1, u[0] + 1, v[1] + 1,
                   u[1] + 1, v[2] + 1, u[2] + 1);
  }
  return out;
}

std::string FormatLayout(const SurfaceFile& file, std::span<const Complex> uv,
                         std::span<const Triangle> corner_uv, std::vector<Warning>& warnings) {
  const std::string made = file.text.empty() ? FormatObj(file) : std::string();
  LayoutWriter writer(file, file.text.empty() ? made : file.text, uv, corner_uv);
  std::string out = writer.Write();
  if (const std::vector<std::uint32_t>& split = writer.split_faces(); !split.empty()) {
    Warning& warning = warnings.emplace_back();
    warning.kind = "split_polygons";
    warning.count = split.size();
    warning.elements.assign(split.begin(), split.begin() + static_cast<std::ptrdiff_t>(std::min(
                                                               split.size(), Fault::kMaxElements)));
    warning.message = fmt::format(
        "faces that the layout cuts across are written as triangles, the first is {} {} ({} in "
        "all)",
        file.face_lines.empty() ? "face" : "that of line", file.PlaceOf(split.front()),
        split.size());
  }
  return out;
}

std::vector<Complex> InUnitSquare(std::span<const Complex> uv) {
  Bounds box;
  box.Add(uv);
  // Halves, so that no difference overflows.
  const double half = std::max(box.max_x / 2 - box.min_x / 2, box.max_y / 2 - box.min_y / 2);
  const auto scaled = [&](double x, double from) {
    return half > 0 ? std::min((x / 2 - from / 2) / half, 1.0) : 0.0;
  };
  std::vector<Complex> unit;
  unit.reserve(uv.size());
  for (const Complex p : uv)
    unit.emplace_back(scaled(p.real(), box.min_x), scaled(p.imag(), box.min_y));
  return unit;
}

}  // namespace arap
