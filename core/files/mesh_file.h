// Triangle meshes in files: Wavefront OBJ (.obj) and OFF (.off); and the shapes that one takes,
// frame by frame, in shapes.csv: a header "frame,x0,y0,x1,y1,…", then a row per frame.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "arap/base/result.h"
#include "arap/model/mesh.h"
#include "core/files/text_file.h"

namespace arap {

// The format is that of the name's ending. Faults name the file: kNotFound (it cannot be opened) or
// kInvalidOption (another ending, or what the parsers refuse).
Result<SurfaceMesh> ReadSurfaceMesh(const std::string& path);
// The same for a mesh in the plane: all z must be equal, and are dropped.
Result<PlanarMesh> ReadPlanarMesh(const std::string& path);

// The texts of such files. Vertices keep their order, also those that no triangle uses; texture
// coordinates and normals are passed over. kInvalidOption when the text is not in the format, a
// face is no triangle or an index is not there.
Result<SurfaceMesh> ParseObj(std::string text);
Result<SurfaceMesh> ParseOff(std::string text);

// The text of an OBJ file. Numbers are the shortest that read back exactly; z is 0 for a mesh of
// the plane.
std::string FormatObj(const PlanarMesh& mesh);
std::string FormatObj(const SurfaceMesh& mesh);
// With a layout: a vt for each flat position in `uv` (#U), and `corner_uv` (#F) says which of them
// each corner has.
std::string FormatObj(const SurfaceMesh& mesh, std::span<const Complex> uv,
                      std::span<const Triangle> corner_uv);

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
