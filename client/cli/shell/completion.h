// What may stand for a word: for one that is not finished, as shells ask, and for one that was
// mistyped.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

namespace arap::cli {

// The word by which the scripts ask.
inline constexpr std::string_view kCompleteWord = "__complete";

struct Candidate {
  std::string word;
  std::string help;  // one line, or empty
};

struct Candidates {
  bool files = false;  // names of files fit too
  std::vector<Candidate> words;
};

// What may stand for the last of the words after "arapctl", which may be empty, in the order of the help.
// Only what begins as that word does.
Candidates Complete(const CLI::App& app, std::span<const std::string> words);

// As the scripts read it: a line "files" or "words", then a line for each: the word, a tab, its help.
std::string FormatCandidates(const Candidates& candidates);

// The script for "bash", "zsh" or "fish"; empty for another shell.
std::string_view CompletionScript(std::string_view shell);

// The least number of letters to insert, remove, change or swap with their neighbour that makes one word
// the other; case does not count. O(|a| |b|).
std::size_t Slips(std::string_view a, std::string_view b);

// The names that are nearest to a word, in their order: those that it is the beginning of, else those
// that few slips for its length make of it. Empty when nothing is near.
std::vector<std::string> Nearest(std::string_view word, const std::vector<std::string>& names);

// "; did you mean --server?", "; did you mean a, b or c?", or empty.
std::string DidYouMean(std::string_view word, const std::vector<std::string>& names);

}  // namespace arap::cli
