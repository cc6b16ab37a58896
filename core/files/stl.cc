// STL: a text, or the binary form.
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/base/try.h"
#include "core/files/bytes.h"
#include "core/files/formats.h"
#include "core/files/text_scan.h"

namespace arap {
namespace {

constexpr std::size_t kStlHeader = 80;  // bytes of any kind, then the count
constexpr std::size_t kStlStart = kStlHeader + sizeof(std::uint32_t);
constexpr std::size_t kStlTriangle = 12 * sizeof(float) + sizeof(std::uint16_t);

// Triangles with corners of their own.
struct StlSoup {
  std::vector<Point3> corners;       // three for each triangle
  std::vector<std::uint32_t> lines;  // of each triangle; none where there are no lines
  std::vector<std::pair<std::size_t, std::string>> solids;  // the first triangle, and the name
};

// Whether a word is this one, in any case. `wanted` is in lower case.
bool IsStlWord(std::string_view word, std::string_view wanted) {
  return std::equal(word.begin(), word.end(), wanted.begin(), wanted.end(), [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == b;
  });
}

class StlText {
 public:
  StlText(std::string_view text, const std::string& name) : name_(name), scanner_(text) {}

  Result<StlSoup> Read() {
    for (std::string_view word; !(word = scanner_.NextWord()).empty();) {
      if (!IsStlWord(word, "solid")) return OutOfPlace(word, "'solid'");
      soup_.solids.emplace_back(soup_.corners.size() / 3, scanner_.Rest());
      CHECK_OK(ReadSolid());
    }
    return std::move(soup_);
  }

 private:
  auto Bad(std::string_view what) const { return FailAt(name_, scanner_.line(), what); }
  tl::unexpected<Fault> OutOfPlace(std::string_view word, std::string_view wanted) const {
    if (word.empty()) {
      return Bad(fmt::format("the text ends within a solid: {} is wanted", wanted));
    }
    return Bad(fmt::format("{}: {} is wanted", Quoted(word), wanted));
  }

  Status Expect(std::string_view wanted) {
    const std::string_view word = scanner_.NextWord();
    if (IsStlWord(word, wanted)) return {};
    return OutOfPlace(word, fmt::format("'{}'", wanted));
  }

  Status ReadSolid() {
    for (;;) {
      const std::string_view word = scanner_.NextWord();
      if (IsStlWord(word, "endsolid")) break;
      if (!IsStlWord(word, "facet")) return OutOfPlace(word, "'facet' or 'endsolid'");
      CHECK_OK(ReadFacet());
    }
    (void)scanner_.Rest();  // the name once more
    return {};
  }

  Status ReadFacet() {
    const std::size_t line = scanner_.line();
    std::string_view word = scanner_.NextWord();
    if (IsStlWord(word, "normal")) {
      // Three words of any kind: a program that finds no normal may write nan.
      for (int k = 0; k < 3; ++k) (void)scanner_.NextWord();
      word = scanner_.NextWord();
    }
    if (!IsStlWord(word, "outer")) return OutOfPlace(word, "'outer loop'");
    CHECK_OK(Expect("loop"));
    for (int corner = 0; corner < 3; ++corner) {
      CHECK_OK(Expect("vertex"));
      Point3& point = soup_.corners.emplace_back();
      for (double& x : point) {
        word = scanner_.NextWord();
        if (word.empty()) return OutOfPlace(word, "a number");
        const Result<double> number = ParseNumber(word);
        if (!number) return Bad(number.error().message);
        x = *number;
      }
    }
    CHECK_OK(Expect("endloop"));
    CHECK_OK(Expect("endfacet"));
    soup_.lines.push_back(static_cast<std::uint32_t>(line));
    return {};
  }

  const std::string& name_;
  TextScanner scanner_;
  StlSoup soup_;
};

Result<StlSoup> ReadBinaryStl(std::string_view bytes, const std::string& name) {
  if (bytes.size() < kStlStart) {
    return Fail(FaultKind::kInvalidOption,
                fmt::format("{}: not STL: a text begins with 'solid', and the binary form has {} "
                            "bytes at least, not {}",
                            name, kStlStart, bytes.size()));
  }
  const auto claimed = NumberAt<std::uint32_t>(bytes, kStlHeader);
  const std::size_t rest = bytes.size() - kStlStart, wanted = claimed * kStlTriangle;
  if (wanted > rest) {
    return FailAtByte(name, kStlHeader,
                      fmt::format("the header claims {} triangles, the file has room for {}",
                                  claimed, rest / kStlTriangle));
  }
  if (wanted < rest) {
    return FailAtByte(name, kStlStart + wanted,
                      fmt::format("the file goes on for {} bytes behind the {} triangles that the "
                                  "header claims",
                                  rest - wanted, claimed));
  }
  StlSoup soup;
  soup.corners.reserve(std::size_t{claimed} * 3);
  for (std::size_t t = 0; t < claimed; ++t) {
    std::size_t at = kStlStart + t * kStlTriangle + 3 * sizeof(float);  // behind the normal
    for (int corner = 0; corner < 3; ++corner) {
      Point3& point = soup.corners.emplace_back();
      for (double& x : point) {
        x = double{NumberAt<float>(bytes, at)};
        if (!std::isfinite(x)) {
          return FailAtByte(name, at, fmt::format("{} is not a finite number", x));
        }
        at += sizeof(float);
      }
    }
  }
  return soup;
}

// For each corner the first one with the same coordinates.
std::vector<std::uint32_t> FirstTwins(const std::vector<Point3>& corners) {
  std::vector<std::uint32_t> order(corners.size());
  std::iota(order.begin(), order.end(), std::uint32_t{0});
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return corners[a] != corners[b] ? corners[a] < corners[b] : a < b;
  });
  std::vector<std::uint32_t> first(corners.size());
  std::uint32_t twin = 0;
  for (const std::uint32_t corner : order) {
    if (corner == order.front() || corners[corner] != corners[twin]) twin = corner;
    first[corner] = twin;
  }
  return first;
}

Warning StlWarning(const char* kind, std::size_t count, std::string message) {
  Warning warning;
  warning.kind = kind;
  warning.count = count;
  warning.message = std::move(message);
  return warning;
}

Result<SurfaceFile> Joined(StlSoup soup, const std::string& name) {
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  SurfaceFile file;
  std::vector<std::uint32_t> first = FirstTwins(soup.corners);
  std::vector<std::uint32_t> numbers(soup.corners.size(), kNone);
  const std::size_t triangles = soup.corners.size() / 3;
  file.corners.reserve(soup.corners.size());
  file.first_corner.reserve(triangles + 1);
  file.face_lines.reserve(soup.lines.size());
  file.face_numbers.reserve(triangles);
  std::size_t solid = 0, left_out = 0;
  std::string place;  // of the first one that is left out
  for (std::size_t t = 0; t < triangles; ++t) {
    const std::uint32_t* const corner = first.data() + 3 * t;
    if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) {
      if (left_out++ == 0) {
        place = soup.lines.empty() ? fmt::format("{}: face {}", name, t)
                                   : fmt::format("{}:{}", name, soup.lines[t]);
      }
      continue;
    }
    if (solid < soup.solids.size() && soup.solids[solid].first <= t) {
      // Those without triangles are passed over.
      while (solid + 1 < soup.solids.size() && soup.solids[solid + 1].first <= t) ++solid;
      file.BeginObject(std::move(soup.solids[solid++].second));
    }
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t& number = numbers[corner[k]];
      if (number == kNone) {
        number = static_cast<std::uint32_t>(file.mesh.vertices.size());
        file.mesh.vertices.push_back(soup.corners[corner[k]]);
      }
      file.corners.push_back(number);
    }
    file.EndFace(soup.lines.empty() ? 0 : soup.lines[t]);
    file.face_numbers.push_back(static_cast<std::uint32_t>(t));
  }
  if (left_out == 0) file.face_numbers = {};
  if (file.face_count() == 0) {
    return Fail(
        FaultKind::kInvalidOption,
        fmt::format("{}: no triangles with three different corners, {} others", name, left_out));
  }
  if (left_out > 0) {
    file.warnings.push_back(
        StlWarning("empty_triangles", left_out,
                   fmt::format("{}: a triangle with two equal corners is left out ({} in all)",
                               place, left_out)));
  }
  if (file.mesh.vertices.size() < file.corners.size()) {
    file.warnings.push_back(StlWarning(
        "joined_corners", file.corners.size() - file.mesh.vertices.size(),
        fmt::format("{}: every triangle of an STL file has corners of its own; those with equal "
                    "coordinates are one vertex: {} corners, {} vertices",
                    name, file.corners.size(), file.mesh.vertices.size())));
  }
  CHECK_OK(file.CutFaces(name));
  return file;
}

// A text has no zero bytes, the header and the numbers of a binary file do.
bool IsStlText(std::string_view bytes) {
  constexpr std::size_t kLook = 1024;
  return IsStlWord(TextScanner(bytes).NextWord(), "solid") &&
         bytes.substr(0, kLook).find('\0') == std::string_view::npos;
}

}  // namespace

bool IsBinaryStl(std::string_view bytes) {
  if (bytes.size() < kStlStart) return false;
  const std::size_t claimed = NumberAt<std::uint32_t>(bytes, kStlHeader);
  return claimed > 0 && bytes.size() == kStlStart + claimed * kStlTriangle;
}

Result<SurfaceFile> ParseStl(std::string_view bytes, const std::string& name) {
  CHECK_OK(CheckSize(bytes, name));
  if (!IsBinaryStl(bytes) && IsStlText(bytes)) {
    TRY(StlSoup soup, StlText(bytes, name).Read());
    return Joined(std::move(soup), name);
  }
  TRY(StlSoup soup, ReadBinaryStl(bytes, name));
  return Joined(std::move(soup), name);
}

}  // namespace arap
