// What is for people who look at a terminal, and not for files and pipes.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace arap::cli {

// The most that a line of help has; also of what is shown on a terminal that does not say its width.
inline constexpr std::size_t kLineWidth = 80;

// Whether lines that are written over may be sent there: a terminal that can (TERM is not "dumb").
bool IsTerminal(int descriptor);

enum class Look { kStrong, kBad, kDoubtful, kGood };
// The text in bold, red, magenta or green, where `descriptor` is such a terminal and neither NO_COLOR nor
// a TERM without colours asks for plain text.
std::string Styled(int descriptor, Look look, std::string_view text);

// A line on standard error that is written over as the work goes on, and taken away at the end. Shows
// nothing when it is to be silent, or where there is no such terminal. For one thread.
class StatusLine {
 public:
  explicit StatusLine(bool silent = false);
  ~StatusLine();
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;

  void Show(std::string_view text, std::optional<Look> look = {});

 private:
  bool shows_;
  bool shown_ = false;
};

// Words set in lines of at most `width` characters, broken at spaces alone; each line begins with
// `indent` spaces, and none ends with one. A line of the text that begins with a space stays as it is.
// UTF-8 counts by characters. Every line ends with a newline; an empty text has none.
std::string Wrapped(std::string_view text, std::size_t width, std::size_t indent = 0);

// How many characters a text of UTF-8 has.
std::size_t CharactersIn(std::string_view text);

}  // namespace arap::cli
