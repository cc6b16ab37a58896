// A glTF 2.0 file taken apart: its JSON, with the place of every value, and the arrays of numbers
// that it describes. What they mean is left to gltf.cc.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "arap/base/result.h"

namespace arap {

// A value with its place, "a.gltf: accessors[3].count". It refers to the document.
class GltfValue {
 public:
  GltfValue(const nlohmann::json& json, std::string place)
      : json_(&json), place_(std::move(place)) {}

  const std::string& place() const { return place_; }
  // kInvalidOption with the place.
  tl::unexpected<Fault> Bad(std::string_view what) const;

  // The member of an object; nothing when it is missing or this is no object.
  std::optional<GltfValue> Find(const char* member) const;
  // How many entries an array has; 0 for what is none.
  std::size_t size() const { return json_->is_array() ? json_->size() : 0; }
  // The entry of an array; `index` is below the size.
  GltfValue At(std::size_t index) const;

  // The value itself.
  Result<std::size_t> Whole() const;  // below 2^53
  Result<double> Number() const;
  bool IsTrue() const;
  std::string_view Text() const;  // empty for what is no text
  // That of a member, which may be missing where there is something instead.
  Result<std::size_t> Whole(const char* member,
                            std::optional<std::size_t> instead = std::nullopt) const;
  std::string_view Text(const char* member) const;

 private:
  const nlohmann::json* json_;
  std::string place_;
};

// Numbers that lie in a buffer: #count entries, each of which begins `stride` bytes behind the one
// before. All of them are there.
struct GltfArray {
  std::string_view bytes;
  std::size_t count = 0, stride = 0;
  std::size_t component = 0;  // the type of a number, as glTF calls it
  bool normalized = false;    // whole numbers stand for parts of the largest one

  // A number of an entry. Whole numbers below 2^32 are exact.
  double At(std::size_t entry, std::size_t number = 0) const;
};

inline constexpr std::size_t kGltfInt8 = 5120, kGltfUint8 = 5121, kGltfInt16 = 5122,
                             kGltfUint16 = 5123, kGltfUint32 = 5125, kGltfFloat = 5126;

// The bytes of the file beside the document that a relative URI names; `least` of them are wanted.
using LoadBeside = std::function<Result<std::string>(const std::string& path, std::size_t least)>;

// Not to be moved: values refer to it.
class GltfDocument {
 public:
  // `name` is what messages call the file; all three have to outlive this.
  GltfDocument(std::string_view bytes, const std::string& name, const LoadBeside& load);
  GltfDocument(const GltfDocument&) = delete;
  GltfDocument& operator=(const GltfDocument&) = delete;

  // Comes first. kInvalidOption for what is neither JSON nor GLB, another version than 2, and
  // lengths that are not those of the file.
  Status Open();

  // Of the list of all meshes, nodes, …; kInvalidOption with the place of `index`, which is a value
  // that should be its number.
  Result<GltfValue> Get(const char* list, const GltfValue& index) const;
  GltfValue root() const { return {json_, name_ + ": "}; }
  // The numbers of an accessor. `width` is how many there are in an entry. kInvalidOption with the
  // place for what does not lie in its buffer, and for sparse and compressed ones.
  Result<GltfArray> ArrayOf(const GltfValue& index, std::size_t width);

  // The bytes of the file and of those that were read beside it.
  std::size_t size() const { return size_; }

 private:
  Status OpenBinary();
  Result<std::string_view> Buffer(const GltfValue& index);

  std::string_view bytes_;
  const std::string& name_;
  const LoadBeside& load_;
  nlohmann::json json_;
  std::string_view text_;                       // of the JSON
  std::optional<std::string_view> chunk_;       // the binary one
  std::map<std::size_t, std::string> buffers_;  // those that are no part of the file
  std::size_t size_ = 0;
};

}  // namespace arap
