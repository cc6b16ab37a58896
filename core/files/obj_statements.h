// The statements of an OBJ text, for the reader and for the writer that keeps the text.
#pragma once

#include <cstddef>
#include <string_view>

#include "core/files/text_scan.h"

namespace arap {

enum class ObjKeyword : unsigned char {
  kVertex,   // v
  kTexture,  // vt
  kNormal,   // vn
  kFace,     // f, fo
  kLine,     // l
  kObject,   // o
  kGroup,    // g
  kOther,    // known and of no consequence for the surface: materials, smoothing, points, …
  kUnknown,
};

// Goes through a text once. A statement is a keyword with its arguments; a backslash at the end of
// a line joins the next one to it, but in comments and behind names (o, g, materials and their
// files), where it is more often the end of a path. The keywords v, vt, vn and f also begin a
// statement in the middle of a line of one of them. The text must outlive it.
class ObjStatements {
 public:
  explicit ObjStatements(std::string_view text) : scanner_(text) {}

  // Goes on to the next statement; false at the end of the text.
  bool Next();

  ObjKeyword keyword() const { return keyword_; }
  // The keyword as it is written, and where.
  std::string_view word() const { return word_; }
  std::size_t begin() const { return begin_; }
  // Where the line begins that it is on, and whether it is the first on it.
  std::size_t line_begin() const { return line_begin_; }
  bool leads_line() const { return leads_line_; }

  // The next argument; empty after the last one.
  std::string_view Argument();
  // All that is left of the line, as a name.
  std::string_view Name() { return scanner_.Rest(); }

  // The line of the word that was read last, from 1, and the offset behind that word.
  std::size_t line() const { return scanner_.line(); }
  std::size_t at() const { return at_; }

 private:
  void Begin(std::string_view word);

  TextScanner scanner_;
  ObjKeyword keyword_ = ObjKeyword::kOther;
  std::string_view word_;
  std::size_t begin_ = 0, line_begin_ = 0, at_ = 0;
  bool started_ = false, leads_line_ = false;
  std::string_view pending_;  // the keyword of a next statement on this line
};

}  // namespace arap
