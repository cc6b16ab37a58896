// What a server says in the words of who wrote the files. A server counts from 0 and names the fields
// of a request; people look for a line of a file and the flag that named it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "arap/base/fault.h"
#include "arap/base/result.h"
#include "arap/model/mesh.h"
#include "core/files/surface_file.h"

namespace arap::cli {

// How a file counts.
struct Counting {
  std::uint32_t first = 0;  // what it calls vertex 0, and triangle 0 where no faces are known
  // Where the face is that a triangle is of: its line, or its number from 0 in a file without
  // lines. Empty where that is not known. Any triangle may be asked for: one that is not there has 0.
  std::function<std::size_t(std::uint32_t triangle)> face_of;
  bool lines = true;  // what face_of answers
};

// As a file does that was read: OBJ files count from 1, all others from 0. Refers to it; its mesh
// may be gone.
Counting CountingOf(const SurfaceFile& file);

// Where a field of a request comes from.
struct Origin {
  std::string field;  // "pins", which also stands for "pins[3]" and "pins[3].weight"
  std::string entry;  // what one of its entries is called: "the pin"
  Counting counting;
  // The place of what stands behind the field's name ("", "[3]", "[3].weight"): "--pins p.txt:4".
  std::function<std::string(std::string_view rest)> place;
};

// The number in "[3].weight"; `none` where it begins with none.
std::size_t EntryOf(std::string_view rest, std::size_t none);

// The sentence with the numbers that follow "vertex", "edge" and "triangle" (also several of them,
// "triangles 3, 4 and 5") as the file has them, and options of a request as flags.
std::string InOwnWords(std::string_view sentence, const Counting& counting);
// With the place instead of the field, which one of the origins knows; of others as it is. Elements
// become details, as the file counts; the place of a mesh gets the line, or face, of the first
// triangle.
Fault InOwnWords(Fault fault, const std::vector<Origin>& origins);
template <class Value>
Result<Value> InOwnWords(Result<Value> result, const std::vector<Origin>& origins) {
  if (!result) return Fail(InOwnWords(std::move(result).error(), origins));
  return result;
}
// The same for warnings, which are about the mesh; their first elements are told.
std::vector<Warning> InOwnWords(std::vector<Warning> warnings, const Counting& counting);

}  // namespace arap::cli
