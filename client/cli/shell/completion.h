// Completion in shells. The scripts are small and ask arapctl itself (`arapctl __complete -- WORD…`), so
// that they never know other commands and options than it has.
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

}  // namespace arap::cli
