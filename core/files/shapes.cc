#include "core/files/shapes.h"

#include <iterator>

#include <fmt/format.h>

namespace arap {

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
