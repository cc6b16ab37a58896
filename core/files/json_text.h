// JSON that people write: a fault says where it is.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "arap/base/result.h"

namespace arap {

// kInvalidOption, "NAME:3:14: not JSON: what was found instead" with line and column; also for one
// that is nested a hundred times and more.
Result<nlohmann::ordered_json> ParseJson(std::string_view text, const std::string& name);

// The same for JSON that programs write, with the members of objects in any order. It fails too, and
// keeps nothing, when there are more than `most_values` of all kinds: a value takes many times the
// bytes that it may have in the text.
Result<nlohmann::json> ParseJsonData(std::string_view text, const std::string& name,
                                     std::size_t most_values);

// The member of an object, or the element of an array counted from 0.
using JsonStep = std::variant<std::string_view, std::size_t>;

// "NAME:3:14": where the value begins to which the steps lead from the outermost one, or the last of
// them that is there. `text` is one that ParseJson reads. O(text).
std::string JsonPlace(std::string_view text, const std::string& name,
                      const std::vector<JsonStep>& steps);

}  // namespace arap
