// Files of text: read at once, written whole or not at all; and where in a text something stands.
#pragma once

#include <cstddef>
#include <fstream>
#include <string>
#include <string_view>

#include "arap/base/result.h"

namespace arap {

// The name of standard input where a file is read, and of standard output where one is written.
inline constexpr std::string_view kStandardStream = "-";

// The bytes of a file. kNotFound with the path and the system's reason. Standard input can be read once
// in a program; kInvalidOption for a second time.
Result<std::string> ReadBytes(const std::string& path);
// The same without the byte order mark of UTF-8 that some programs begin their files with.
Result<std::string> ReadTextFile(const std::string& path);
std::string_view WithoutByteOrderMark(std::string_view text);
// kInternal with the path and the system's reason; what was there before is then still there.
Status WriteTextFile(const std::string& path, std::string_view text);
// Whether a file could be written there now, as far as folders and permissions say. Makes and
// changes nothing. kInvalidOption with the path and the reason.
Status CheckWritable(const std::string& path);

// A place in a text as editors count: both from 1, columns in characters. Lines end with LF, CRLF or
// CR.
struct TextPlace {
  std::size_t line = 1, column = 1;

  bool operator==(const TextPlace&) const = default;
};
// That of a byte; of the end for one beyond. O(offset).
TextPlace PlaceAt(std::string_view text, std::size_t offset);

// A file that is written piece by piece. It is there when Close has succeeded, in the place of one
// that was there before; else it never was, and its bytes are given back: whoever stops half-way
// leaves nothing that looks like a result. What is no regular file (a pipe, standard output, a link) is
// written as it goes. For one thread.
class OutputFile {
 public:
  explicit OutputFile(std::string path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  // kInternal with the path and the system's reason, also for a file that could not be opened.
  Status Write(std::string_view text);
  Status Close();

 private:
  std::string path_;
  std::string part_;  // what is written until Close, beside the file; empty: the file itself
  std::ofstream file_;
  bool standard_ = false;  // standard output, and not file_
};

}  // namespace arap
