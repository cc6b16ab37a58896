// shapes.csv: a header "frame,x0,y0,x1,y1,…", then a row per frame.
#pragma once

#include <cstddef>
#include <fstream>
#include <span>
#include <string>

#include "arap/base/result.h"
#include "arap/model/mesh.h"

namespace arap {

// Writes rows as they come. Numbers are the shortest that read back exactly. For one thread.
class ShapesFile {
 public:
  // The header needs the number of vertices. Faults (kInternal) come from Close at the latest.
  ShapesFile(const std::string& path, std::size_t vertex_count);

  void Write(std::size_t frame, std::span<const Complex> positions);
  Status Close();

 private:
  std::string path_;
  std::ofstream file_;
};

}  // namespace arap
