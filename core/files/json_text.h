// JSON of files: a fault says where it is, and what it takes is bounded by the text.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "arap/base/result.h"

namespace arap {

// Members of objects in no order: the library copies what it has read when one with an order grows.
using JsonValue = nlohmann::json;

// kInvalidOption, "NAME:3:14: not JSON: what was found instead" with line and column; also for one
// that is nested a hundred times and more, or is large and little more than brackets and commas: the
// values take at most 24 MiB and `per_byte` bytes for each of the text.
Result<JsonValue> ParseJson(std::string_view text, const std::string& name,
                            std::size_t per_byte = 16);

// The member of an object, or the element of an array counted from 0.
using JsonStep = std::variant<std::string_view, std::size_t>;

// "NAME:3:14": where the value begins to which the steps lead from the outermost one, or the last of
// them that is there. `text` is one that ParseJson reads. O(text).
std::string JsonPlace(std::string_view text, const std::string& name,
                      const std::vector<JsonStep>& steps);

}  // namespace arap
