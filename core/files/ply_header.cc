#include "core/files/ply_header.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "core/base/try.h"
#include "core/files/text_file.h"
#include "core/files/text_scan.h"

namespace arap {
namespace {

constexpr std::size_t kMostElements = 100, kMostProperties = 1000;

struct PlyTypeName {
  std::string_view old_name, name;
  std::size_t size;
};

// In the order of PlyType.
constexpr std::array<PlyTypeName, 8> kPlyTypes{{{"char", "int8", 1},
                                                {"uchar", "uint8", 1},
                                                {"short", "int16", 2},
                                                {"ushort", "uint16", 2},
                                                {"int", "int32", 4},
                                                {"uint", "uint32", 4},
                                                {"float", "float32", 4},
                                                {"double", "float64", 8}}};

class PlyHeaderReader {
 public:
  PlyHeaderReader(std::string_view bytes, const std::string& name)
      : bytes_(bytes), name_(name), at_(bytes.size() - WithoutByteOrderMark(bytes).size()) {}

  Result<PlyHeader> Read() {
    if (!NextLine() || Word() != "ply") return Bad("a PLY file begins with 'ply'");
    bool formatted = false;
    while (NextLine()) {
      const std::string_view keyword = Word();
      if (keyword == "end_header") {
        if (!formatted) return Bad("the header names no format");
        header_.lines = line_;
        header_.size = at_;
        return std::move(header_);
      }
      if (keyword == "format") {
        CHECK_OK(ReadFormat());
        formatted = true;
      } else if (keyword == "element") {
        CHECK_OK(ReadElement());
      } else if (keyword == "property") {
        CHECK_OK(ReadProperty());
      } else if (keyword != "comment" && keyword != "obj_info" && !keyword.empty()) {
        return Bad(fmt::format("{} is no keyword of a header", Quoted(keyword)));
      }
    }
    return Bad("the file ends within the header: 'end_header' is missing");
  }

 private:
  tl::unexpected<Fault> Bad(std::string_view what) const {
    return FailAt(name_, std::max(line_, std::size_t{1}), what);
  }

  // False at the end of the bytes. Lines end as the first one does; where that is with CR alone, a
  // line feed behind the last one belongs to what follows.
  bool NextLine() {
    if (at_ == bytes_.size()) return false;
    const std::size_t end = std::min(bytes_.find_first_of("\r\n", at_), bytes_.size());
    rest_ = bytes_.substr(at_, end - at_);
    const bool both = bytes_.substr(end).starts_with("\r\n");
    if (line_++ == 0) cr_alone_ = end < bytes_.size() && bytes_[end] == '\r' && !both;
    at_ = std::min(end + (both && !cr_alone_ ? 2 : 1), bytes_.size());
    return true;
  }

  // The next word of the line; empty at its end.
  std::string_view Word() {
    constexpr std::string_view kBlanks = " \t";
    rest_.remove_prefix(std::min(rest_.find_first_not_of(kBlanks), rest_.size()));
    const std::string_view word = rest_.substr(0, rest_.find_first_of(kBlanks));
    rest_.remove_prefix(word.size());
    return word;
  }

  Status ReadFormat() {
    const std::string_view format = Word(), version = Word();
    if (format == "ascii") {
      header_.format = PlyFormat::kAscii;
    } else if (format == "binary_little_endian") {
      header_.format = PlyFormat::kLittleEndian;
    } else if (format == "binary_big_endian") {
      header_.format = PlyFormat::kBigEndian;
    } else {
      return Bad(fmt::format("{} is no format of PLY", Quoted(format)));
    }
    if (version != "1.0") return Bad(fmt::format("{}: only version 1.0 is read", Quoted(version)));
    return {};
  }

  Status ReadElement() {
    const std::string_view element = Word(), word = Word();
    const Result<std::int64_t> count = ParseWhole(word);
    if (element.empty() || !count || *count < 0) {
      return Bad(fmt::format("{} is not a count of elements", Quoted(word)));
    }
    for (const PlyElement& other : header_.elements) {
      if (other.name == element) return Bad(fmt::format("{} is there twice", Quoted(element)));
    }
    if (header_.elements.size() == kMostElements) {
      return Bad(fmt::format("the limit is {} elements", kMostElements));
    }
    header_.elements.push_back({element, static_cast<std::size_t>(*count), line_, {}});
    return {};
  }

  Status ReadProperty() {
    if (header_.elements.empty()) return Bad("a property without an element");
    PlyElement& element = header_.elements.back();
    PlyProperty property;
    std::string_view word = Word();
    if (word == "list") {
      TRY(property.count, ReadType(Word()));
      if (!IsWhole(*property.count)) return Bad("the length of a list has to be a whole number");
      word = Word();
    }
    TRY(property.type, ReadType(word));
    property.name = Word();
    if (property.name.empty()) return Bad("a property without a name");
    if (element.Find(property.name) < element.properties.size()) {
      return Bad(fmt::format("{} is there twice", Quoted(property.name)));
    }
    if (++properties_ > kMostProperties) {
      return Bad(fmt::format("the limit is {} properties", kMostProperties));
    }
    element.properties.push_back(property);
    return {};
  }

  Result<PlyType> ReadType(std::string_view word) const {
    const auto type = std::find_if(
        kPlyTypes.begin(), kPlyTypes.end(),
        [word](const PlyTypeName& each) { return word == each.name || word == each.old_name; });
    if (type == kPlyTypes.end()) return Bad(fmt::format("{} is no type of PLY", Quoted(word)));
    return static_cast<PlyType>(std::distance(kPlyTypes.begin(), type));
  }

  std::string_view bytes_;
  const std::string& name_;
  std::size_t at_, line_ = 0;
  std::string_view rest_;  // of the line
  bool cr_alone_ = false;
  std::size_t properties_ = 0;
  PlyHeader header_;
};

}  // namespace

std::size_t SizeOf(PlyType type) { return kPlyTypes[static_cast<std::size_t>(type)].size; }

std::size_t PlyElement::Find(std::string_view property) const {
  const auto found =
      std::find_if(properties.begin(), properties.end(),
                   [property](const PlyProperty& each) { return each.name == property; });
  return static_cast<std::size_t>(std::distance(properties.begin(), found));
}

Result<PlyHeader> ParsePlyHeader(std::string_view bytes, const std::string& name) {
  return PlyHeaderReader(bytes, name).Read();
}

}  // namespace arap
