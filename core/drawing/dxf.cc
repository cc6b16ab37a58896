#include "core/drawing/dxf.h"

#include <array>
#include <cstdint>
#include <iterator>
#include <string_view>

#include <fmt/format.h>

#include "core/drawing/outline.h"

namespace arap {
namespace {

struct Layer {
  std::string_view name;
  int color;  // AutoCAD's number
};
constexpr std::array<Layer, 4> kLayers{{{"OUTLINE", 7}, {"SEAM", 1}, {"GRAIN", 5}, {"CUT", 3}}};

// A file is pairs of lines: what the value is, and the value.
class Writer {
 public:
  template <class Value>
  void Pair(int code, const Value& value) {
    fmt::format_to(std::back_inserter(text_), "{:>3}\n{}\n", code, value);
  }
  void Point(int code, Complex p) {
    Pair(code, fmt::format("{:.6f}", p.real()));
    Pair(code + 10, fmt::format("{:.6f}", p.imag()));
  }
  void Begin(std::string_view name) {
    Pair(0, "SECTION");
    Pair(2, name);
  }
  void End() { Pair(0, "ENDSEC"); }

  template <class PointAt>
  void Polyline(std::string_view layer, std::size_t count, bool closed, PointAt point_at) {
    Pair(0, "POLYLINE");
    Pair(8, layer);
    Pair(66, 1);  // vertices follow
    Pair(70, closed ? 1 : 0);
    Point(10, 0);
    Pair(30, "0.0");
    for (std::size_t i = 0; i < count; ++i) {
      Pair(0, "VERTEX");
      Pair(8, layer);
      Point(10, point_at(i));
      Pair(30, "0.0");
    }
    Pair(0, "SEQEND");
    Pair(8, layer);
  }

  std::string Take() { return std::move(text_); }

 private:
  std::string text_;
};

void WriteHeader(const Pattern& pattern, Writer& out) {
  Bounds bounds;
  for (const auto& loop : pattern.outlines) {
    for (const std::uint32_t u : loop) bounds.Add(pattern.points[u]);
  }
  for (const Ring& ring : pattern.allowance) bounds.Add(ring);
  out.Pair(999, "millimetres");
  out.Begin("HEADER");
  out.Pair(9, "$ACADVER");
  out.Pair(1, "AC1009");
  out.Pair(9, "$EXTMIN");
  out.Point(10, {bounds.min_x, bounds.min_y});
  out.Pair(30, "0.0");
  out.Pair(9, "$EXTMAX");
  out.Point(10, {bounds.max_x, bounds.max_y});
  out.Pair(30, "0.0");
  out.End();
}

void WriteTables(Writer& out) {
  out.Begin("TABLES");
  out.Pair(0, "TABLE");
  out.Pair(2, "LTYPE");
  out.Pair(70, 1);
  out.Pair(0, "LTYPE");
  out.Pair(2, "CONTINUOUS");
  out.Pair(70, 0);
  out.Pair(3, "Solid line");
  out.Pair(72, 65);
  out.Pair(73, 0);
  out.Pair(40, "0.0");
  out.Pair(0, "ENDTAB");
  out.Pair(0, "TABLE");
  out.Pair(2, "LAYER");
  out.Pair(70, kLayers.size());
  for (const Layer& layer : kLayers) {
    out.Pair(0, "LAYER");
    out.Pair(2, layer.name);
    out.Pair(70, 0);
    out.Pair(62, layer.color);
    out.Pair(6, "CONTINUOUS");
  }
  out.Pair(0, "ENDTAB");
  out.End();
}

}  // namespace

std::string FormatDxf(const Pattern& pattern) {
  Writer out;
  WriteHeader(pattern, out);
  WriteTables(out);
  out.Begin("ENTITIES");
  const auto along = [&](const std::vector<std::uint32_t>& line) {
    return [&pattern, &line](std::size_t i) { return pattern.points[line[i]]; };
  };
  for (const auto& loop : pattern.outlines) {
    out.Polyline("OUTLINE", loop.size(), /*closed=*/true, along(loop));
  }
  for (const auto& seam : pattern.seams) {
    out.Polyline("SEAM", seam.size(), /*closed=*/false, along(seam));
  }
  for (const Ring& ring : pattern.allowance) {
    out.Polyline("CUT", ring.size(), /*closed=*/true, [&ring](std::size_t i) { return ring[i]; });
  }
  for (const auto& line : pattern.grain_lines) {
    out.Pair(0, "LINE");
    out.Pair(8, "GRAIN");
    out.Point(10, line[0]);
    out.Pair(30, "0.0");
    out.Point(11, line[1]);
    out.Pair(31, "0.0");
  }
  out.End();
  out.Pair(0, "EOF");
  return out.Take();
}

}  // namespace arap
