#include "client/cli/terminal.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>

#include <fmt/format.h>
#include <unistd.h>

namespace arap::cli {
namespace {

bool IsSet(const char* variable) {
  const char* const value = std::getenv(variable);
  return value != nullptr && *value != '\0';
}

// One paragraph, its lines appended to `out`.
void WrapLine(std::string_view line, std::size_t width, std::size_t indent, std::string& out) {
  const std::string margin(indent, ' ');
  std::string current;
  std::size_t length = 0;
  const auto flush = [&] {
    out += current.empty() ? "\n" : margin + current + "\n";
    current.clear();
    length = 0;
  };
  while (!line.empty()) {
    const std::size_t end = std::min(line.find(' '), line.size());
    const std::string_view word = line.substr(0, end);
    line.remove_prefix(std::min(end + 1, line.size()));
    if (word.empty()) continue;
    const std::size_t more = CharactersIn(word);
    if (length > 0 && indent + length + 1 + more > width) flush();
    if (length > 0) {
      current += ' ';
      ++length;
    }
    current += word;
    length += more;
  }
  flush();
}

}  // namespace

bool IsTerminal(int descriptor) {
  const char* const term = std::getenv("TERM");
  return isatty(descriptor) == 1 && !(term != nullptr && std::string_view(term) == "dumb");
}

std::string Styled(int descriptor, Look look, std::string_view text) {
  if (IsSet("NO_COLOR") || !IsSet("TERM") || !IsTerminal(descriptor)) return std::string(text);
  // Magenta where others take yellow, which is hard to read on white.
  constexpr std::array<int, 4> kCodes{1, 31, 35, 32};
  return fmt::format("\033[{}m{}\033[0m", kCodes[static_cast<std::size_t>(look)], text);
}

StatusLine::StatusLine(bool silent) : shows_(!silent && IsTerminal(STDERR_FILENO)) {}

StatusLine::~StatusLine() {
  if (shown_) fmt::print(stderr, "\r\033[K");
}

void StatusLine::Show(std::string_view text, std::optional<Look> look) {
  if (!shows_) return;
  fmt::print(stderr, "\r{}\033[K", look ? Styled(STDERR_FILENO, *look, text) : std::string(text));
  std::fflush(stderr);
  shown_ = true;
}

std::string Wrapped(std::string_view text, std::size_t width, std::size_t indent) {
  std::string out;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.starts_with(' ')) {
      out += std::string(indent, ' ').append(line) + "\n";
    } else {
      WrapLine(line, width, indent, out);
    }
  }
  return out;
}

std::size_t CharactersIn(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xc0U) != 0x80;
  }));
}

}  // namespace arap::cli
