// The formats of meshes that are read: Wavefront OBJ (.obj), OFF (.off), PLY (.ply), STL (.stl) and glTF
// 2.0 (.gltf, .glb), each in a .cc of its name. Every reader takes a whole file and answers its surface;
// `name` is what messages call that file.
#pragma once

#include <string>
#include <string_view>

#include "arap/base/result.h"
#include "core/files/gltf_document.h"
#include "core/files/surface_file.h"

namespace arap {

// The surface of an OBJ text.
//
// Read are: any line ends, a byte order mark, comments, joined lines; v with two numbers (z is 0),
// three, four (a weight, told when it is not 1) and a colour of three or four numbers behind; every
// form of f, indices that count back, faces before their vertices, polygons; objects and groups.
// Vertices keep their order, also those that no face uses. Texture coordinates, normals, lines and
// materials do not matter here and stay in the text. Unknown statements are counted in a warning.
//
// kInvalidOption with the place and the word for anything that is no finite number or no index of a
// vertex, for faces of fewer than three corners, and for a text without faces. The memory is
// bounded by the text.
Result<SurfaceFile> ParseObj(std::string text, const std::string& name);

// The surface of an OFF text.
//
// Read are: any line ends, a byte order mark, comments; the keyword in any case, with C, N or ST
// before it, glued to the counts or missing; two counts or three; polygons. Each vertex and each
// face has a line of its own, with colours and the like behind, which are passed over; or there are
// no such extras, and the lines are cut anywhere.
//
// kInvalidOption with the place and the word for anything that is no finite number or no index of a
// vertex, for counts that are more or less than the text holds, for faces of fewer than three
// corners, and for the variants with other dimensions and in binary. The memory is bounded by the
// text, whatever it claims.
Result<SurfaceFile> ParseOff(std::string_view text, const std::string& name);

// The surface of a PLY file, a text or either binary form.
//
// Read are x, y and z of the vertices, of any type, and the corners of the faces, of any whole type;
// the elements in any order; polygons. In a text every element has a line of its own. All other
// properties and elements are passed over, and a warning names them.
//
// kInvalidOption with the line and the word, or the byte, for anything that is no finite number or no
// index of a vertex, for counts that are more or less than the file holds, for faces of fewer than
// three corners, for triangle strips, and for a file without faces. The memory is bounded by the
// file, whatever it claims.
Result<SurfaceFile> ParsePly(std::string_view bytes, const std::string& name);

// Whether the bytes have exactly the length of a binary STL file with as many triangles as they say.
bool IsBinaryStl(std::string_view bytes);

// The surface of an STL file, a text or the binary form. What the length shows to be binary is read
// so, whatever its first bytes are: many such files begin with "solid". Normals, attributes and
// colours are passed over. A text may have several solids, which become objects.
//
// In STL every triangle has corners of its own. Those with equal coordinates become one vertex, in
// the order in which the file has them first, and a warning says so. Triangles with two equal
// corners cover nothing and are left out, with a warning too.
//
// kInvalidOption with the line and the word, or the byte, for anything that is no finite number, for
// text out of place, for files that end early or go on behind what they claim to hold, and for those
// without triangles. The memory is bounded by the file. O(n log n).
Result<SurfaceFile> ParseStl(std::string_view bytes, const std::string& name);

// The surface of a glTF file, as JSON or GLB: of all meshes of its scene. `load` reads buffers that are
// files beside it.
//
// Read are the triangles of the scene that the file opens with, of the first one or, without scenes,
// of all nodes; each where the transforms of its nodes put it. The vertices of a mesh keep their
// order; parts of a mesh that share their vertices go on sharing them. Positions are floats or short
// whole numbers (KHR_mesh_quantization). Every node becomes an object with its name, or that of its
// mesh.
//
// Told in warnings and passed over: points and lines, morph targets, skins (a skinned mesh stays as
// it is modelled) and the colours, normals and the like of vertices. Refused by name: triangle strips
// and fans, sparse accessors, compressed data and every other required extension that could change
// the shape. kInvalidOption for these too, and for whatever does not fit together. The memory is
// bounded by the file, also where many nodes show one mesh.
Result<SurfaceFile> ParseGltf(std::string_view bytes, const std::string& name,
                              const LoadBeside& load);

}  // namespace arap
