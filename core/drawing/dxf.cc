// The DXF of a pattern.
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/base/code_point.h"
#include "core/drawing/pattern_files.h"

namespace arap {
namespace {

struct Layer {
  std::string_view name;
  int color;  // AutoCAD's number
};

// By LineKind, and that of labels at the end.
constexpr std::array<Layer, 6> kLayers{
    {{"OUTLINE", 7}, {"SEAM", 1}, {"CUT", 3}, {"GRAIN", 5}, {"NOTCH", 6}, {"LABEL", 8}}};

std::string_view NameOf(LineKind kind) { return kLayers[static_cast<std::size_t>(kind)].name; }

// A file is pairs of lines: what the value is, and the value. Everything in it has a handle, a
// number of its own, and names the handle of its owner.
class Writer {
 public:
  explicit Writer(int digits) : digits_(digits) {}

  template <class Value>
  void Pair(int code, const Value& value) {
    fmt::format_to(std::back_inserter(text_), "{:>3}\n{}\n", code, value);
  }
  void Point(int code, Complex p) {
    Pair(code, fmt::format("{:.{}f}", p.real(), digits_));
    Pair(code + 10, fmt::format("{:.{}f}", p.imag(), digits_));
  }
  void Point3(int code, Complex p) {
    Point(code, p);
    Pair(code + 20, "0.0");
  }
  // A variable of the header.
  template <class Value>
  void Variable(std::string_view name, int code, const Value& value) {
    Pair(9, name);
    Pair(code, value);
  }

  // Begins `type`, of a new handle that is answered; `classes` are those that its values are of.
  int Begin(std::string_view type, int owner, std::initializer_list<std::string_view> classes) {
    Pair(0, type);
    // The one kind of entry whose handle has a code of its own.
    Pair(type == "DIMSTYLE" ? 105 : 5, fmt::format("{:X}", next_));
    Pair(330, fmt::format("{:X}", owner));
    for (const std::string_view name : classes) Pair(100, name);
    return next_++;
  }
  int Table(std::string_view name, std::size_t entries) {
    Pair(0, "TABLE");
    Pair(2, name);
    Pair(5, fmt::format("{:X}", next_));
    Pair(330, 0);
    Pair(100, "AcDbSymbolTable");
    Pair(70, entries);
    return next_++;
  }
  // The lines before every entry's own.
  int Entry(std::string_view table, int owner, std::string_view kind, std::string_view name) {
    const int handle = Begin(table, owner, {"AcDbSymbolTableRecord", kind});
    Pair(2, name);
    return handle;
  }

  void Section(std::string_view name) {
    Pair(0, "SECTION");
    Pair(2, name);
  }

  int next() const { return next_; }
  std::string Take() { return std::move(text_); }

 private:
  int digits_;
  int next_ = 0x10;
  std::string text_;
};

void WriteHeader(const Bounds& box, int next_handle, Writer& out) {
  out.Section("HEADER");
  out.Variable("$ACADVER", 1, "AC1015");
  out.Variable("$DWGCODEPAGE", 3, "ANSI_1252");
  out.Variable("$INSUNITS", 70, 4);     // millimetres
  out.Variable("$MEASUREMENT", 70, 1);  // metric
  out.Variable("$LUNITS", 70, 2);       // decimal
  out.Pair(9, "$EXTMIN");
  out.Point3(10, {box.min_x, box.min_y});
  out.Pair(9, "$EXTMAX");
  out.Point3(10, {box.max_x, box.max_y});
  out.Variable("$HANDSEED", 5, fmt::format("{:X}", next_handle));
  out.Pair(0, "ENDSEC");
}

void WriteLineTypes(Writer& out) {
  constexpr std::array<std::string_view, 3> kNames{"ByBlock", "ByLayer", "Continuous"};
  const int table = out.Table("LTYPE", kNames.size());
  for (const std::string_view name : kNames) {
    out.Entry("LTYPE", table, "AcDbLinetypeTableRecord", name);
    out.Pair(70, 0);
    out.Pair(3, "");
    out.Pair(72, 65);
    out.Pair(73, 0);
    out.Pair(40, "0.0");
  }
  out.Pair(0, "ENDTAB");
}

void WriteLayers(Writer& out) {
  const int table = out.Table("LAYER", kLayers.size() + 1);
  const auto layer = [&](std::string_view name, int color) {
    out.Entry("LAYER", table, "AcDbLayerTableRecord", name);
    out.Pair(70, 0);
    out.Pair(62, color);
    out.Pair(6, "Continuous");
  };
  layer("0", 7);
  for (const Layer& own : kLayers) layer(own.name, own.color);
  out.Pair(0, "ENDTAB");
}

void WriteStyles(Writer& out) {
  const int table = out.Table("STYLE", 1);
  out.Entry("STYLE", table, "AcDbTextStyleTableRecord", "Standard");
  out.Pair(70, 0);
  out.Pair(40, "0.0");
  out.Pair(41, "1.0");
  out.Pair(50, "0.0");
  out.Pair(71, 0);
  out.Pair(42, "2.5");
  out.Pair(3, "txt");
  out.Pair(4, "");
  out.Pair(0, "ENDTAB");
}

void WriteDimensionStyles(Writer& out) {
  const int table = out.Table("DIMSTYLE", 1);
  out.Pair(100, "AcDbDimStyleTable");
  out.Pair(71, 1);
  out.Entry("DIMSTYLE", table, "AcDbDimStyleTableRecord", "Standard");
  out.Pair(70, 0);
  out.Pair(0, "ENDTAB");
}

// The blocks that every file has: what is drawn, and a sheet of paper with nothing on it.
struct Spaces {
  int model = 0, paper = 0;
};

Spaces WriteTables(Writer& out) {
  out.Section("TABLES");
  for (const std::string_view empty : {"VPORT", "VIEW", "UCS"}) {
    out.Table(empty, 0);
    out.Pair(0, "ENDTAB");
  }
  WriteLineTypes(out);
  WriteLayers(out);
  WriteStyles(out);
  const int applications = out.Table("APPID", 1);
  out.Entry("APPID", applications, "AcDbRegAppTableRecord", "ACAD");
  out.Pair(70, 0);
  out.Pair(0, "ENDTAB");
  WriteDimensionStyles(out);
  const int blocks = out.Table("BLOCK_RECORD", 2);
  Spaces spaces;
  spaces.model = out.Entry("BLOCK_RECORD", blocks, "AcDbBlockTableRecord", "*Model_Space");
  spaces.paper = out.Entry("BLOCK_RECORD", blocks, "AcDbBlockTableRecord", "*Paper_Space");
  out.Pair(0, "ENDTAB");
  out.Pair(0, "ENDSEC");
  return spaces;
}

void WriteBlocks(const Spaces& spaces, Writer& out) {
  out.Section("BLOCKS");
  for (const auto& [owner, name] :
       {std::pair(spaces.model, "*Model_Space"), std::pair(spaces.paper, "*Paper_Space")}) {
    out.Begin("BLOCK", owner, {"AcDbEntity"});
    out.Pair(8, 0);
    out.Pair(100, "AcDbBlockBegin");
    out.Pair(2, name);
    out.Pair(70, 0);
    out.Point3(10, 0);
    out.Pair(3, name);
    out.Pair(1, "");
    out.Begin("ENDBLK", owner, {"AcDbEntity"});
    out.Pair(8, 0);
    out.Pair(100, "AcDbBlockEnd");
  }
  out.Pair(0, "ENDSEC");
}

void WriteLine(const PatternLine& line, int owner, Writer& out) {
  const bool straight = line.kind == LineKind::kGrain || line.kind == LineKind::kNotch;
  out.Begin(straight ? "LINE" : "LWPOLYLINE", owner, {"AcDbEntity"});
  out.Pair(8, NameOf(line.kind));
  if (straight) {
    out.Pair(100, "AcDbLine");
    out.Point3(10, line.points[0]);
    out.Point3(11, line.points[1]);
    return;
  }
  out.Pair(100, "AcDbPolyline");
  out.Pair(90, line.points.size());
  out.Pair(70, line.closed ? 1 : 0);
  for (const Complex p : line.points) out.Point(10, p);
}

bool IsKnown(const CodePoint& point) {
  constexpr std::uint32_t kLast = 0xffff;  // four digits
  return point.IsHarmless() && point.value <= kLast;
}

// UTF-8 as the format has it, where characters beyond ASCII are \U+ and four digits; what has none is
// a question mark, and so is what would end the line. What would be read as a code is kept from it:
// ^ has a space behind it, and %% one between.
std::string Escaped(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const CodePoint point(text);
    if (!IsKnown(point)) {
      out += '?';
    } else if (point.value >= 0x80 || point.value == '\\') {
      fmt::format_to(std::back_inserter(out), "\\U+{:04X}", point.value);
    } else {
      if (text.front() == '%' && out.ends_with('%')) out += ' ';
      out += text.front();
      if (text.front() == '^') out += ' ';
    }
    text.remove_prefix(point.length);
  }
  return out;
}

void WriteLabel(const PatternLabel& label, int owner, Writer& out) {
  out.Begin("TEXT", owner, {"AcDbEntity"});
  out.Pair(8, kLayers.back().name);
  out.Pair(100, "AcDbText");
  out.Point3(10, label.at);
  out.Pair(40, fmt::format("{:.3f}", label.height));
  out.Pair(1, Escaped(label.text));
  out.Pair(72, 1);  // centred at the second point
  out.Point3(11, label.at);
  out.Pair(100, "AcDbText");
  out.Pair(73, 2);
}

// The dictionary that every file has.
void WriteObjects(Writer& out) {
  out.Section("OBJECTS");
  const int root = out.Begin("DICTIONARY", 0, {"AcDbDictionary"});
  out.Pair(281, 1);
  out.Pair(3, "ACAD_GROUP");
  out.Pair(350, fmt::format("{:X}", root + 1));
  out.Begin("DICTIONARY", root, {"AcDbDictionary"});
  out.Pair(281, 1);
  out.Pair(0, "ENDSEC");
}

}  // namespace

bool DxfShows(std::string_view text) {
  while (!text.empty()) {
    const CodePoint point(text);
    if (!IsKnown(point)) return false;
    text.remove_prefix(point.length);
  }
  return true;
}

std::string FormatDxf(const Pattern& pattern) {
  const int digits = DigitsFor(pattern) + 3;
  Writer body(digits);
  const Spaces spaces = WriteTables(body);
  WriteBlocks(spaces, body);
  body.Section("ENTITIES");
  for (const PatternPiece& piece : pattern.pieces) {
    for (const PatternLine& line : piece.lines) WriteLine(line, spaces.model, body);
    for (const PatternLabel& label : piece.labels) WriteLabel(label, spaces.model, body);
  }
  body.Pair(0, "ENDSEC");
  WriteObjects(body);
  body.Pair(0, "EOF");
  // The header comes first and has to know the handles that are taken.
  Writer header(digits);
  WriteHeader(pattern.Box(), body.next(), header);
  header.Section("CLASSES");
  header.Pair(0, "ENDSEC");
  return header.Take() + body.Take();
}

}  // namespace arap
