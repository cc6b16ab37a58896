// A surface as a file has it: the mesh for the work, and what leads from the mesh back to the file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/mesh.h"

namespace arap {

// From this face on the file speaks of this object and group.
struct SurfacePart {
  std::uint32_t first_face = 0;
  std::uint32_t object = 0, group = 0;  // in `names`
};

// #V vertices and #P faces in the order of the file; #F triangles, those of a face one after the
// other. It takes at most twelve bytes for each byte of the file, and a little more.
struct SurfaceFile {
  // Faces of more than three corners are cut into triangles.
  SurfaceMesh mesh;
  // What was passed over or doubted; the sentences name the file and the line.
  std::vector<Warning> warnings;
  // The text of an OBJ file, for writing it again; empty when it was another format.
  std::string text;

  std::vector<std::uint32_t> corners;             // vertices, face by face
  std::vector<std::uint32_t> first_corner{0};     // #P + 1, in `corners`
  std::vector<std::uint32_t> first_triangle{0};   // #P + 1
  std::vector<std::uint32_t> face_lines;          // #P, from 1; empty where there are no lines
  std::vector<std::uint32_t> face_numbers;        // #P; empty where it is 0, 1, 2, …
  std::vector<std::string> names{std::string()};  // the first one stands for none
  std::vector<SurfacePart> parts;                 // by first_face; may begin behind face 0
  // Whether the file tells more of its vertices and faces than is read: colours, normals and the
  // like. Of an OBJ file all of it stays in the text.
  bool has_extras = false;

  std::size_t face_count() const { return first_corner.size() - 1; }
  std::span<const std::uint32_t> CornersOf(std::size_t face) const {
    return std::span(corners).subspan(first_corner[face],
                                      first_corner[face + 1] - first_corner[face]);
  }
  // The face that a triangle is of.
  std::size_t FaceOf(std::size_t triangle) const;
  // What the file calls the object or the group that a face is of; empty: nothing. The views live
  // as long as this.
  std::string_view ObjectOf(std::size_t face) const;
  std::string_view GroupOf(std::size_t face) const;

  // Where a face is in the file: its line, or its number, counted from 0, where there are no lines.
  std::size_t PlaceOf(std::size_t face) const;
  // The same in the file `name`: "name:7", or "name: face 7".
  std::string PlaceOf(const std::string& name, std::size_t face) const;

  // From the next face on the file speaks of this object, which need not have a name. What ends
  // lines, or means something else to a terminal, becomes _.
  void BeginObject(std::string object);
  // Ends a face whose corners were appended; 0 where there are no lines.
  void EndFace(std::size_t line = 0);
  // Makes the triangles of all faces, and warnings of those that there is no right cut for. What a
  // reader does last. kInvalidOption with the place for a face that is too long to cut.
  Status CutFaces(const std::string& name);
};

}  // namespace arap
