// Files of text: read at once, written whole or not at all.
#pragma once

#include <fstream>
#include <string>
#include <string_view>

#include "arap/base/result.h"

namespace arap {

// kNotFound with the path and the system's reason.
Result<std::string> ReadTextFile(const std::string& path);
// kInternal with the path and the system's reason; what was there before is then still there.
Status WriteTextFile(const std::string& path, std::string_view text);

// A file that is written piece by piece. It is there when Close has succeeded, in the place of one
// that was there before; else it never was, and its bytes are given back: whoever stops half-way
// leaves nothing that looks like a result. What is no regular file (a pipe, /dev/stdout, a link) is
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
};

}  // namespace arap
