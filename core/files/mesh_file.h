// Meshes in files, Wavefront OBJ (.obj) and OFF (.off); and the shapes that one takes, frame by
// frame, in shapes.csv: a header "frame,x0,y0,x1,y1,…", then a row per frame.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/mesh.h"
#include "core/files/obj.h"
#include "core/files/text_file.h"

namespace arap {

// The format is that of the name's ending; standard input is OFF where it begins so, else OBJ. Faults name the file: kNotFound (it cannot be opened) or
// kInvalidOption (another ending, or what ParseObj and ParseOff refuse).
Result<SurfaceFile> ReadSurfaceFile(const std::string& path);
// Its mesh alone, without the warnings.
Result<SurfaceMesh> ReadSurfaceMesh(const std::string& path);
// The same for a mesh in any plane (plane_fit.h), in coordinates of that plane. To `notes`, where there
// are such, are added the warnings of the reader, and which plane that is when it is not that of x and
// y. kInvalidOption too for a mesh that is in no plane.
Result<PlanarMesh> ReadPlanarMesh(const std::string& path, std::vector<Warning>* notes = nullptr);

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
