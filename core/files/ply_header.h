// The header of a PLY file: what the bytes behind it mean.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "arap/base/result.h"

namespace arap {

enum class PlyType : std::uint8_t {
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kFloat,
  kDouble
};

std::size_t SizeOf(PlyType type);
inline bool IsWhole(PlyType type) { return type < PlyType::kFloat; }

struct PlyProperty {
  std::string_view name;
  PlyType type{};                // of the value, or of each entry of a list
  std::optional<PlyType> count;  // a list begins with its length in this type
};

struct PlyElement {
  std::string_view name;
  std::size_t count = 0;  // as the header claims
  std::size_t line = 0;
  std::vector<PlyProperty> properties;

  // #properties when there is none of this name.
  std::size_t Find(std::string_view property) const;
};

enum class PlyFormat : std::uint8_t { kAscii, kLittleEndian, kBigEndian };

// The names are parts of the file's bytes.
struct PlyHeader {
  PlyFormat format = PlyFormat::kAscii;
  std::vector<PlyElement> elements;  // in the order of the file
  std::size_t lines = 0;             // of the header
  std::size_t size = 0;              // of the header, in bytes
};

// kInvalidOption with the line for a header that is none, for types and formats that are unknown, and
// for more than a hundred elements or a thousand properties.
Result<PlyHeader> ParsePlyHeader(std::string_view bytes, const std::string& name);

}  // namespace arap
