// What somebody may have meant who has mistyped a word.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace arap::cli {

// The least number of letters to insert, remove, change or swap with their neighbour that makes one word
// the other; case does not count. O(|a| |b|).
std::size_t Slips(std::string_view a, std::string_view b);

// The names that are nearest to a word, in their order: those that it is the beginning of, else those
// that few slips for its length make of it. Empty when nothing is near.
std::vector<std::string> Nearest(std::string_view word, const std::vector<std::string>& names);

// "; did you mean --server?", "; did you mean a, b or c?", or empty.
std::string DidYouMean(std::string_view word, const std::vector<std::string>& names);

}  // namespace arap::cli
