// A text taken apart word by word, and its words as numbers, with sentences for those that are
// none. Nothing here depends on the locale.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "arap/base/result.h"

namespace arap {

// Goes through a text once, from its first byte to its last. Lines end with LF, CRLF or CR; blanks
// separate words; # begins a comment, which ends with its line. A byte order mark at the beginning
// is passed over. The text must outlive it.
class TextScanner {
 public:
  explicit TextScanner(std::string_view text);

  // The next word of this line, or empty at its end. With `continued` a backslash at the end of a
  // line is a blank, and the next line belongs to this one.
  std::string_view Word(bool continued = false);
  // The next word on whatever line; empty at the end of the text.
  std::string_view NextWord();
  // The rest of this line without the blanks around it.
  std::string_view Rest();
  // Goes on to the beginning of the next line; false at the end of the text.
  bool NextLine();

  // The line of the word that was read last, from 1.
  std::size_t line() const { return line_; }
  // The offset of the byte that comes next.
  std::size_t at() const { return at_; }

 private:
  bool BackslashEndsLine(std::size_t at) const;
  void PassLineEnd();

  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
};

// kInvalidOption with "name: …" for 4 GiB and more.
Status CheckSize(std::string_view bytes, const std::string& name);
// The same, and for a text that no reader of text takes: UTF-16.
Status CheckText(std::string_view text, const std::string& name);

// kInvalidOption with "name:line: …".
tl::unexpected<Fault> FailAt(const std::string& name, std::size_t line, std::string_view what);
// The word in quotes, its beginning when it is long.
std::string Quoted(std::string_view word);

// The whole word as a finite number; what is too small for a double is zero. The messages of the
// faults quote the word and name no place.
Result<double> ParseNumber(std::string_view word);
// The whole word as a whole number.
Result<std::int64_t> ParseWhole(std::string_view word);

}  // namespace arap
