#include "client/cli/suggest.h"

#include <algorithm>
#include <cctype>
#include <numeric>
#include <utility>

namespace arap::cli {
namespace {

char Small(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

}  // namespace

std::size_t Slips(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before, last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = Small(a[i - 1]) == Small(b[j - 1]);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (same ? 0 : 1)});
      if (i > 1 && j > 1 && Small(a[i - 1]) == Small(b[j - 2]) &&
          Small(a[i - 2]) == Small(b[j - 1])) {
        row[j] = std::min(row[j], before[j - 2] + 1);
      }
    }
    before = std::exchange(last, row);
  }
  return last.back();
}

std::vector<std::string> Nearest(std::string_view word, const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 3;
  // "--t" is the beginning of too much to say anything.
  const std::size_t dashes = std::min(word.find_first_not_of('-'), word.size());
  std::vector<std::string> found;
  if (word.size() - dashes >= 2) {
    for (const std::string& name : names) {
      if (std::string_view(name).starts_with(word)) found.push_back(name);
    }
  }
  if (!found.empty() && found.size() <= kMost) return found;
  found.clear();
  std::size_t least = std::max<std::size_t>(1, (word.size() - dashes) / 3);
  for (const std::string& name : names) {
    const std::size_t slips = Slips(word, name);
    if (slips > least) continue;
    if (slips < least) found.clear();
    least = slips;
    found.push_back(name);
  }
  if (found.size() > kMost) found.resize(kMost);
  return found;
}

std::string DidYouMean(std::string_view word, const std::vector<std::string>& names) {
  const std::vector<std::string> near = Nearest(word, names);
  std::string text;
  for (std::size_t i = 0; i < near.size(); ++i) {
    text += i == 0 ? "" : i + 1 == near.size() ? " or " : ", ";
    text += near[i];
  }
  return text.empty() ? text : "; did you mean " + text + "?";
}

}  // namespace arap::cli
