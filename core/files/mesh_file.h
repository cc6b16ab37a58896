// Meshes in files: Wavefront OBJ (.obj), OFF (.off), STL (.stl), PLY (.ply) and glTF (.gltf, .glb),
// also packed by gzip (.gz); and the shapes that one takes, frame by frame, in shapes.csv: a header
// "frame,x0,y0,x1,y1,…", then a row per frame.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/mesh.h"
#include "core/files/surface_file.h"
#include "core/files/text_file.h"

namespace arap {

// The format is that of the content, where that shows it, and else that of the name's ending; when
// they differ a warning says so. Standard input is OBJ where its content shows nothing else. Faults
// name the file: kNotFound (it cannot be opened, or what a glTF file names beside it) or
// kInvalidOption (no such format, or what its reader and Unpack refuse).
Result<SurfaceFile> ReadSurfaceFile(const std::string& path);
// Its mesh alone, without the warnings.
Result<SurfaceMesh> ReadSurfaceMesh(const std::string& path);
// The same for a mesh in any plane (plane_fit.h), in coordinates of that plane. kInvalidOption too for
// a mesh that is in no plane.
Result<PlanarMesh> ReadPlanarMesh(const std::string& path);

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
