// OFF.
#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/base/try.h"
#include "core/files/formats.h"
#include "core/files/text_scan.h"

namespace arap {
namespace {

// Whether each vertex and each face has a line of its own.
enum class OffLayout : std::uint8_t { kLines, kFree };

class OffReader {
 public:
  OffReader(std::string_view text, const std::string& name)
      : name_(name), size_(text.size()), scanner_(text) {}

  Result<SurfaceFile> Read() {
    CHECK_OK(ReadHeader());
    const TextScanner body = scanner_;
    const Status in_lines = ReadBody(OffLayout::kLines);
    if (!in_lines) {
      scanner_ = body;
      file_ = {};
      // Lines are the rule: what is wrong with them is told when it cannot be read in either way.
      if (!ReadBody(OffLayout::kFree)) return Fail(in_lines.error());
    }
    CHECK_OK(file_.CutFaces(name_));
    return std::move(file_);
  }

 private:
  auto Bad(std::string_view what) const { return FailAt(name_, scanner_.line(), what); }

  Status ReadHeader() {
    std::string_view word = scanner_.NextWord();
    std::string upper(word.substr(0, kLongestKeyword));
    std::transform(upper.begin(), upper.end(), upper.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    if (const std::size_t off = upper.find("OFF"); off != std::string::npos) {
      // n for any number of dimensions is small: NOFF has normals.
      if (upper.substr(0, off).find('4') != std::string::npos || word.starts_with("nOFF")) {
        return Bad(fmt::format("{}: only surfaces in space are read", Quoted(word)));
      }
      if (upper.find_first_not_of("STCN") != off) {
        return Bad(fmt::format("{} is not OFF", Quoted(word)));
      }
      word.remove_prefix(off + 3);
      if (word.empty()) word = scanner_.NextWord();
      if (word == "BINARY") return Bad("'BINARY': only texts are read");
    } else if (word.find_first_of("+-0123456789") != 0 && !word.empty()) {
      return Bad(fmt::format("{} is not OFF", Quoted(word)));
    }
    return ReadCounts(word);
  }

  Status ReadCounts(std::string_view word) {
    if (word.empty()) {
      return Fail(FaultKind::kInvalidOption, name_ + ": the text ends before the counts");
    }
    const std::size_t line = scanner_.line();
    TRY(vertices_, ReadCount(word));
    std::string_view second = scanner_.Word();
    const bool apart = second.empty();  // one on a line: then there are three
    if (apart) second = scanner_.NextWord();
    TRY(faces_, ReadCount(second));
    const std::string_view third = apart ? scanner_.NextWord() : scanner_.Word();
    if (!third.empty()) {
      // That of the edges, which nobody fills in rightly.
      TRY([[maybe_unused]] const std::size_t edges, ReadCount(third));
    }
    // A vertex takes six bytes at least, "0 0 0" and a blank, a face eight.
    counts_line_ = line;
    const std::size_t rest = size_ - scanner_.at() + 1;
    CHECK_OK(CheckRoom(vertices_, rest / 6, "vertices"));
    return CheckRoom(faces_, rest / 8, "faces");
  }

  Result<std::size_t> ReadCount(std::string_view word) {
    if (word.empty()) {
      return Fail(FaultKind::kInvalidOption, name_ + ": the text ends before the counts");
    }
    const Result<std::int64_t> count = ParseWhole(word);
    if (!count) return Bad(count.error().message);
    if (*count < 0) return Bad(fmt::format("{} is not a count", Quoted(word)));
    return static_cast<std::size_t>(*count);
  }

  Status CheckRoom(std::size_t claimed, std::size_t most, const char* what) const {
    if (claimed <= most) return {};
    return FailAt(name_, counts_line_,
                  fmt::format("'{}': the header claims {} {}, the file has room for {}", claimed,
                              claimed, what, most));
  }

  Status ReadBody(OffLayout layout) {
    file_.mesh.vertices.reserve(vertices_);
    while (file_.mesh.vertices.size() < vertices_) CHECK_OK(ReadVertex(layout));
    file_.first_corner.reserve(faces_ + 1);
    file_.face_lines.reserve(faces_);
    while (file_.face_count() < faces_) CHECK_OK(ReadFace(layout));
    if (const std::string_view word = scanner_.NextWord(); !word.empty()) {
      return Bad(
          fmt::format("{}: the file goes on behind the {} vertices and {} faces that the "
                      "header claims",
                      Quoted(word), vertices_, faces_));
    }
    if (faces_ == 0) return Fail(FaultKind::kInvalidOption, name_ + ": no faces");
    return {};
  }

  // The first word of a vertex or face.
  Result<std::string_view> FirstWord(std::size_t claimed) {
    last_word_ = scanner_.NextWord();
    if (!last_word_.empty()) return last_word_;
    return FailAt(
        name_, counts_line_,
        fmt::format("'{}': the header claims {} vertices and {} faces, the file ends "
                    "after {} and {}",
                    claimed, vertices_, faces_, file_.mesh.vertices.size(), file_.face_count()));
  }

  // Another one of the same.
  Result<std::string_view> LaterWord(OffLayout layout, std::size_t wanted, const char* what) {
    const std::string_view word =
        layout == OffLayout::kLines ? scanner_.Word() : scanner_.NextWord();
    if (!word.empty()) return last_word_ = word;
    return Bad(
        fmt::format("{} is the last word, {} {} are wanted", Quoted(last_word_), wanted, what));
  }

  Result<double> ReadNumber(std::string_view word) const {
    Result<double> number = ParseNumber(word);
    if (!number) return Bad(number.error().message);
    return number;
  }

  Status ReadVertex(OffLayout layout) {
    Point3 point{};
    TRY(std::string_view word, FirstWord(vertices_));
    for (std::size_t k = 0; k < point.size(); ++k) {
      if (k > 0) {
        TRY(word, LaterWord(layout, 3, "numbers of a vertex"));
      }
      TRY(point[k], ReadNumber(word));
    }
    file_.mesh.vertices.push_back(point);
    return layout == OffLayout::kLines ? PassExtras(kMostVertexExtras) : Status();
  }

  Status ReadFace(OffLayout layout) {
    TRY(const std::string_view first, FirstWord(faces_));
    const std::size_t line = scanner_.line();
    TRY(const std::size_t corners, ReadCount(first));
    if (corners < 3) {
      return Bad(fmt::format("{}: a face has three corners or more", Quoted(first)));
    }
    for (std::size_t k = 0; k < corners; ++k) {
      TRY(const std::string_view word, LaterWord(layout, corners, "corners of a face"));
      const Result<std::int64_t> vertex = ParseWhole(word);
      if (!vertex) return Bad(vertex.error().message);
      if (*vertex < 0 || static_cast<std::size_t>(*vertex) >= vertices_) {
        return Bad(fmt::format("{}: there is no such vertex, they go from 0 to {}", Quoted(word),
                               static_cast<std::int64_t>(vertices_) - 1));
      }
      file_.corners.push_back(static_cast<std::uint32_t>(*vertex));
    }
    file_.EndFace(line);
    return layout == OffLayout::kLines ? PassExtras(kMostFaceExtras) : Status();
  }

  // Numbers behind a vertex or a face: colours, normals, texture coordinates.
  Status PassExtras(std::size_t most) {
    std::size_t count = 0;
    for (std::string_view word; !(word = scanner_.Word()).empty();) {
      if (++count > most) return Bad(fmt::format("{} is one number too many", Quoted(word)));
      TRY([[maybe_unused]] const double number, ReadNumber(word));
      file_.has_extras = true;
    }
    return {};
  }

  static constexpr std::size_t kLongestKeyword = 9;     // STCN4nOFF
  static constexpr std::size_t kMostVertexExtras = 10;  // w, a normal, a colour, s and t
  static constexpr std::size_t kMostFaceExtras = 4;     // a colour

  const std::string& name_;
  std::size_t size_;
  TextScanner scanner_;
  SurfaceFile file_;
  std::size_t vertices_ = 0, faces_ = 0;  // as the header claims
  std::size_t counts_line_ = 0;
  std::string_view last_word_;
};

}  // namespace

Result<SurfaceFile> ParseOff(std::string_view text, const std::string& name) {
  CHECK_OK(CheckText(text, name));
  return OffReader(text, name).Read();
}

}  // namespace arap
