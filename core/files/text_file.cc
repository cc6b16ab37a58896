#include "core/files/text_file.h"

#include <cerrno>
#include <filesystem>
#include <sstream>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "core/base/try.h"

namespace arap {
namespace {

auto CannotWrite(const std::string& path) {
  const std::string reason = errno != 0 ? std::generic_category().message(errno) : "unknown reason";
  return Fail(FaultKind::kInternal, fmt::format("cannot write {}: {}", path, reason));
}

}  // namespace

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
  OutputFile file(path);
  CHECK_OK(file.Write(text));
  return file.Close();
}

OutputFile::OutputFile(std::string path) : path_(std::move(path)) {
  std::error_code error;
  const auto kind = std::filesystem::symlink_status(path_, error).type();
  if (kind == std::filesystem::file_type::regular ||
      kind == std::filesystem::file_type::not_found) {
    part_ = fmt::format("{}.{}.part", path_, getpid());
    file_.open(part_, std::ios::binary);
  }
  if (!file_.is_open()) {
    part_.clear();  // a folder that takes no new file may let an old one be written
    errno = 0;
    file_.open(path_, std::ios::binary);
  }
}

OutputFile::~OutputFile() {
  std::error_code ignored;
  if (!part_.empty()) std::filesystem::remove(part_, ignored);
}

Status OutputFile::Write(std::string_view text) {
  if (file_) errno = 0;  // else the reason is that of the opening, or of the write that failed
  file_ << text;
  if (!file_) return CannotWrite(path_);
  return {};
}

Status OutputFile::Close() {
  if (file_) errno = 0;
  file_.close();
  if (!file_) return CannotWrite(path_);
  if (part_.empty()) return {};
  std::error_code error;
  const auto old = std::filesystem::status(path_, error);
  if (std::filesystem::exists(old)) {
    std::filesystem::permissions(part_, old.permissions(), error);
  }
  std::filesystem::rename(part_, path_, error);
  if (error) {
    errno = error.value();
    return CannotWrite(path_);
  }
  part_.clear();
  return {};
}

}  // namespace arap
