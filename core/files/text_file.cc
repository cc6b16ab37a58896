#include "core/files/text_file.h"

#include <cerrno>
#include <fstream>
#include <sstream>
#include <system_error>

#include <fmt/format.h>

namespace arap {

Result<std::string> ReadTextFile(const std::string& path) {
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  // A directory opens, but has nothing to read.
  if (!file || !(text << file.rdbuf())) {
    const std::string reason =
        errno != 0 ? std::generic_category().message(errno) : "nothing to read";
    return Fail(FaultKind::kNotFound, fmt::format("{}: {}", path, reason));
  }
  return std::move(text).str();
}

Status WriteTextFile(const std::string& path, std::string_view text) {
  errno = 0;
  std::ofstream file(path, std::ios::binary);
  file << text << std::flush;
  if (!file) {
    return Fail(FaultKind::kInternal,
                fmt::format("cannot write {}: {}", path, std::generic_category().message(errno)));
  }
  return {};
}

}  // namespace arap
