// PLY: a text, or either binary form.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/base/try.h"
#include "core/files/bytes.h"
#include "core/files/formats.h"
#include "core/files/ply_header.h"
#include "core/files/text_scan.h"

namespace arap {
namespace {

// What stands behind the header, number by number. Both kinds have the same members.
class PlyText {
 public:
  PlyText(std::string_view bytes, const PlyHeader& header, const std::string& name)
      : size_(bytes.size() - header.size),
        header_lines_(header.lines),
        name_(name),
        scanner_(bytes.substr(header.size)) {}

  tl::unexpected<Fault> Bad(std::string_view what) const { return FailAt(name_, line(), what); }
  std::size_t line() const { return header_lines_ + scanner_.line(); }
  std::size_t left() const { return size_ - scanner_.at(); }
  // A number and what separates it from the next one.
  static std::size_t LeastSize(PlyType /*type*/) { return 2; }

  Status Begin() {
    while ((next_ = scanner_.Word()).empty()) {
      if (!scanner_.NextLine()) return Bad("the file ends before what the header claims");
    }
    return {};
  }
  Result<double> Take(PlyType type) {
    CHECK_OK(CheckWord());
    const std::string_view word = std::exchange(next_, scanner_.Word());
    if (IsWhole(type)) {
      const Result<std::int64_t> number = ParseWhole(word);
      if (!number) return Bad(number.error().message);
      return static_cast<double>(*number);
    }
    Result<double> number = ParseNumber(word);
    if (!number) return Bad(number.error().message);
    return number;
  }
  Status Skip(PlyType /*type*/, std::size_t count) {
    for (; count > 0; --count) {
      CHECK_OK(CheckWord());
      next_ = scanner_.Word();
    }
    return {};
  }
  Status End() const {
    if (next_.empty()) return {};
    return Bad(fmt::format("{} is one word too many", Quoted(next_)));
  }
  Status CheckEnd() {
    if (!Begin()) return {};
    return Bad(fmt::format("{}: the file goes on behind what the header claims", Quoted(next_)));
  }

 private:
  Status CheckWord() const {
    if (!next_.empty()) return {};
    return Bad("the line ends before all its properties are there");
  }

  std::size_t size_, header_lines_;
  const std::string& name_;
  TextScanner scanner_;
  std::string_view next_;  // word of the line
};

class PlyBytes {
 public:
  PlyBytes(std::string_view bytes, const PlyHeader& header, const std::string& name)
      : bytes_(bytes),
        name_(name),
        at_(header.size),
        order_(header.format == PlyFormat::kBigEndian ? ByteOrder::kBig : ByteOrder::kLittle) {}

  // At the number that was taken last.
  tl::unexpected<Fault> Bad(std::string_view what) const { return FailAtByte(name_, taken_, what); }
  static std::size_t line() { return 0; }  // there are none
  std::size_t left() const { return bytes_.size() - at_; }
  static std::size_t LeastSize(PlyType type) { return SizeOf(type); }

  static Status Begin() { return {}; }
  Result<double> Take(PlyType type) {
    taken_ = at_;
    if (left() < SizeOf(type)) return Bad("the file ends before what the header claims");
    at_ += SizeOf(type);
    const double number = Number(type);
    if (!std::isfinite(number)) return Bad(fmt::format("{} is not a finite number", number));
    return number;
  }
  Status Skip(PlyType type, std::size_t count) {
    taken_ = at_;
    if (left() / SizeOf(type) < count) return Bad("the file ends before what the header claims");
    at_ += SizeOf(type) * count;
    return {};
  }
  static Status End() { return {}; }
  Status CheckEnd() const {
    if (left() == 0) return {};
    return FailAtByte(
        name_, at_,
        fmt::format("the file goes on for {} bytes behind what the header claims", left()));
  }

 private:
  double Number(PlyType type) const {
    switch (type) {
      case PlyType::kInt8:
        return NumberAt<std::int8_t>(bytes_, taken_, order_);
      case PlyType::kUint8:
        return NumberAt<std::uint8_t>(bytes_, taken_, order_);
      case PlyType::kInt16:
        return NumberAt<std::int16_t>(bytes_, taken_, order_);
      case PlyType::kUint16:
        return NumberAt<std::uint16_t>(bytes_, taken_, order_);
      case PlyType::kInt32:
        return NumberAt<std::int32_t>(bytes_, taken_, order_);
      case PlyType::kUint32:
        return NumberAt<std::uint32_t>(bytes_, taken_, order_);
      case PlyType::kFloat:
        return double{NumberAt<float>(bytes_, taken_, order_)};
      case PlyType::kDouble:
        break;
    }
    return NumberAt<double>(bytes_, taken_, order_);
  }

  std::string_view bytes_;
  const std::string& name_;
  std::size_t at_, taken_ = 0;
  ByteOrder order_;
};

// What of the elements is read, by number of element and property.
struct PlyPlan {
  std::size_t vertices = 0, faces = 0;  // elements
  std::array<std::size_t, 3> xyz{};     // properties of a vertex
  std::size_t corners = 0;              // that of a face
  std::string passed_over;              // names of all others
  std::size_t passed_over_count = 0;
};

Result<PlyPlan> PlanOf(const PlyHeader& header, const std::string& name) {
  const auto bad = [&](const PlyElement& element, std::string_view what) {
    return FailAt(name, element.line, what);
  };
  PlyPlan plan;
  plan.vertices = plan.faces = header.elements.size();
  for (std::size_t e = 0; e < header.elements.size(); ++e) {
    const PlyElement& element = header.elements[e];
    if (element.properties.empty() && element.count > 0) {
      return bad(element, fmt::format("{} has no properties", Quoted(element.name)));
    }
    if (element.name == "vertex") plan.vertices = e;
    if (element.name == "face") plan.faces = e;
    if (element.name == "tristrips" && element.count > 0) {
      return bad(element, "'tristrips': triangle strips are not read");
    }
  }
  if (plan.vertices == header.elements.size() || plan.faces == header.elements.size() ||
      header.elements[plan.faces].count == 0) {
    return Fail(FaultKind::kInvalidOption, name + ": no faces, or no vertices");
  }
  const PlyElement& vertex = header.elements[plan.vertices];
  for (std::size_t k = 0; k < 3; ++k) {
    const std::string_view axis = std::string_view("xyz").substr(k, 1);
    plan.xyz[k] = vertex.Find(axis);
    if (plan.xyz[k] == vertex.properties.size() || vertex.properties[plan.xyz[k]].count) {
      return bad(vertex, fmt::format("the vertices have no {}", axis));
    }
  }
  const PlyElement& face = header.elements[plan.faces];
  plan.corners = std::min(face.Find("vertex_indices"), face.Find("vertex_index"));
  if (plan.corners == face.properties.size() || !face.properties[plan.corners].count ||
      !IsWhole(face.properties[plan.corners].type)) {
    return bad(face, "the faces have no list of whole numbers 'vertex_indices'");
  }
  const auto pass_over = [&plan](std::string_view what) {
    constexpr std::size_t kMostNames = 8;
    if (plan.passed_over_count++ < kMostNames) {
      plan.passed_over += (plan.passed_over.empty() ? "" : ", ") + Quoted(what);
    } else if (!plan.passed_over.ends_with("…")) {
      plan.passed_over += ", …";
    }
  };
  for (std::size_t e = 0; e < header.elements.size(); ++e) {
    const PlyElement& element = header.elements[e];
    if (e != plan.vertices && e != plan.faces) {
      pass_over(element.name);
      continue;
    }
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const bool read =
          e == plan.faces ? p == plan.corners : std::count(plan.xyz.begin(), plan.xyz.end(), p) > 0;
      if (!read) pass_over(element.properties[p].name);
    }
  }
  return plan;
}

template <class Source>
class PlyBody {
 public:
  PlyBody(std::string_view bytes, const PlyHeader& header, const PlyPlan& plan,
          const std::string& name)
      : header_(header), plan_(plan), name_(name), source_(bytes, header, name) {}

  Result<SurfaceFile> Read() {
    for (std::size_t e = 0; e < header_.elements.size(); ++e) {
      const PlyElement& element = header_.elements[e];
      CHECK_OK(CheckRoom(e));
      if (e == plan_.vertices) file_.mesh.vertices.reserve(element.count);
      if (e == plan_.faces) file_.first_corner.reserve(element.count + 1);
      for (std::size_t i = 0; i < element.count; ++i) CHECK_OK(ReadItem(e));
    }
    CHECK_OK(source_.CheckEnd());
    return std::move(file_);
  }

 private:
  // That as many as are claimed can be there: before anything is reserved for them.
  Status CheckRoom(std::size_t e) const {
    const PlyElement& element = header_.elements[e];
    if (element.count == 0) return {};
    std::size_t least = 0;
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      least += Source::LeastSize(property.count.value_or(property.type));
      if (e == plan_.faces && p == plan_.corners) least += 3 * Source::LeastSize(property.type);
    }
    const std::size_t room = (source_.left() + 1) / least;  // the last line of a text may be open
    if (element.count <= room) return {};
    return FailAt(name_, element.line,
                  fmt::format("'{}': the header claims {} elements {}, the file has room for {}",
                              element.count, element.count, Quoted(element.name), room));
  }

  Status ReadItem(std::size_t e) {
    CHECK_OK(source_.Begin());
    const PlyElement& element = header_.elements[e];
    Point3 point{};
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      const auto axis = std::find(plan_.xyz.begin(), plan_.xyz.end(), p);
      if (e == plan_.vertices && axis != plan_.xyz.end()) {
        TRY(point[static_cast<std::size_t>(axis - plan_.xyz.begin())], source_.Take(property.type));
      } else if (e == plan_.faces && p == plan_.corners) {
        CHECK_OK(ReadCorners(property));
      } else if (property.count) {
        TRY(const std::size_t length, ReadLength(*property.count, 0));
        CHECK_OK(source_.Skip(property.type, length));
      } else {
        CHECK_OK(source_.Skip(property.type, 1));
      }
    }
    if (e == plan_.vertices) file_.mesh.vertices.push_back(point);
    if (e == plan_.faces) file_.EndFace(source_.line());
    return source_.End();
  }

  Result<std::size_t> ReadLength(PlyType type, std::size_t least) {
    TRY(const double length, source_.Take(type));
    if (length < static_cast<double>(least)) {
      return source_.Bad(least == 0
                             ? fmt::format("'{}' is not a length of a list", length)
                             : fmt::format("'{}': a face has three corners or more", length));
    }
    return static_cast<std::size_t>(length);
  }

  Status ReadCorners(const PlyProperty& property) {
    TRY(const std::size_t length, ReadLength(*property.count, 3));
    const std::size_t vertices = header_.elements[plan_.vertices].count;
    for (std::size_t k = 0; k < length; ++k) {
      TRY(const double vertex, source_.Take(property.type));
      if (vertex < 0 || vertex >= static_cast<double>(vertices)) {
        return source_.Bad(fmt::format("'{}': there is no such vertex, they go from 0 to {}",
                                       vertex, static_cast<std::int64_t>(vertices) - 1));
      }
      file_.corners.push_back(static_cast<std::uint32_t>(vertex));
    }
    return {};
  }

  const PlyHeader& header_;
  const PlyPlan& plan_;
  const std::string& name_;
  Source source_;
  SurfaceFile file_;
};

}  // namespace

Result<SurfaceFile> ParsePly(std::string_view bytes, const std::string& name) {
  CHECK_OK(CheckSize(bytes, name));
  TRY(const PlyHeader header, ParsePlyHeader(bytes, name));
  TRY(const PlyPlan plan, PlanOf(header, name));
  TRY(SurfaceFile file, header.format == PlyFormat::kAscii
                            ? PlyBody<PlyText>(bytes, header, plan, name).Read()
                            : PlyBody<PlyBytes>(bytes, header, plan, name).Read());
  if (plan.passed_over_count > 0) {
    file.has_extras = true;
    Warning& warning = file.warnings.emplace_back();
    warning.kind = "unknown_properties";
    warning.count = plan.passed_over_count;
    warning.message = fmt::format("{}: properties and elements are passed over: {} ({} in all)",
                                  name, plan.passed_over, plan.passed_over_count);
  }
  CHECK_OK(file.CutFaces(name));
  return file;
}

}  // namespace arap
