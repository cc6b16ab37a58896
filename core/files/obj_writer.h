// Wavefront OBJ (.obj): the text of a surface, made anew or with a flat layout in the text that it was
// read from.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "arap/model/mesh.h"
#include "core/files/surface_file.h"

namespace arap {

// The text of an OBJ file. Numbers are the shortest that read back exactly; z is 0 for a mesh of
// the plane.
std::string FormatObj(const PlanarMesh& mesh);
std::string FormatObj(const SurfaceMesh& mesh);
// With the faces and the objects that a file of any format has.
std::string FormatObj(const SurfaceFile& file);
// With a layout: a vt for each flat position in `uv` (#U), and `corner_uv` (#F) says which of them
// each corner has.
std::string FormatObj(const SurfaceMesh& mesh, std::span<const Complex> uv,
                      std::span<const Triangle> corner_uv);

// The text that the surface was read from, byte by byte, but for texture coordinates: a vt for each
// flat position in `uv` (#U) where the first one was, or else before the first face, and in every
// corner of a face the one that `corner_uv` (#F) has for it. The old vt lines are gone, and so are
// the indices of lines (l) into them. Faces that the layout is cut across cannot be kept: they are
// written as their triangles, and `warnings` gets one that says how many. The text of a
// surface of another format is what FormatObj makes of it.
std::string FormatLayout(const SurfaceFile& file, std::span<const Complex> uv,
                         std::span<const Triangle> corner_uv, std::vector<Warning>& warnings);

// The positions moved and scaled alike, so that the larger side of the box around them goes from 0
// to 1. Positions without an extent become 0.
std::vector<Complex> InUnitSquare(std::span<const Complex> uv);

}  // namespace arap
