// Man pages of arapctl, made of its help.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace arap::cli {

struct ManPage {
  std::string name;  // "arapctl-token-add"
  std::string text;  // roff, with the macros of man
};

// The page of a command: `words` are its names below arapctl, none for arapctl itself. The same tree
// gives the same bytes; there is no date in it.
ManPage ManPageOf(const CLI::App& command, const std::vector<std::string>& words,
                  const std::string& version);

// That of arapctl and of every command that does something.
std::vector<ManPage> ManPages(const CLI::App& app, const std::string& version);

}  // namespace arap::cli
