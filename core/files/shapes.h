// shapes.csv: a header "frame,x0,y0,x1,y1,…", then a row per frame.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "arap/base/result.h"
#include "arap/model/mesh.h"
#include "core/files/text_file.h"

namespace arap {

// Writes rows as they come. Numbers are the shortest that read back exactly. Without a Close that
// succeeds there is no file. Faults (kInternal) name it. For one thread.
class ShapesFile {
 public:
  // The header needs the number of vertices; Write says when it could not be written.
  ShapesFile(const std::string& path, std::size_t vertex_count);

  Status Write(std::size_t frame, std::span<const Complex> positions);
  Status Close() { return file_.Close(); }

 private:
  OutputFile file_;
};

}  // namespace arap
