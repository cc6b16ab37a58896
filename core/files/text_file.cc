#include "core/files/text_file.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <sstream>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "core/base/try.h"

namespace arap {
namespace {

std::string Reason(int error) {
  return error != 0 ? std::generic_category().message(error) : "unknown reason";
}

auto CannotWrite(const std::string& path) {
  return Fail(FaultKind::kInternal, fmt::format("cannot write {}: {}", path, Reason(errno)));
}

auto CannotBeWritten(const std::string& path, std::string_view reason) {
  return Fail(FaultKind::kInvalidOption, fmt::format("cannot write {}: {}", path, reason));
}

Result<std::string> ReadStandardInput() {
  static std::atomic<bool> was_read = false;
  if (was_read.exchange(true)) {
    return Fail(FaultKind::kInvalidOption, "standard input (-) stands for one file, not for two.");
  }
  std::string text;
  std::array<char, 65536> buffer{};
  errno = 0;
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), stdin)) {
    text.append(buffer.data(), count);
  }
  if (std::ferror(stdin) != 0) {
    return Fail(FaultKind::kNotFound, fmt::format("standard input: {}", Reason(errno)));
  }
  return text;
}

}  // namespace

Result<std::string> ReadBytes(const std::string& path) {
  if (path == kStandardStream) return ReadStandardInput();
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

Result<std::string> ReadTextFile(const std::string& path) {
  TRY(std::string text, ReadBytes(path));
  text.erase(0, text.size() - WithoutByteOrderMark(text).size());
  return text;
}

std::string_view WithoutByteOrderMark(std::string_view text) {
  constexpr std::string_view kMark = "\xef\xbb\xbf";
  return text.substr(text.starts_with(kMark) ? kMark.size() : 0);
}

Status WriteTextFile(const std::string& path, std::string_view text) {
  OutputFile file(path);
  CHECK_OK(file.Write(text));
  return file.Close();
}

Status CheckWritable(const std::string& path) {
  namespace fs = std::filesystem;
  if (path == kStandardStream) return {};
  std::error_code error;
  const fs::file_status file = fs::status(path, error);
  if (fs::is_directory(file)) return CannotBeWritten(path, "it is a folder");
  fs::path target = path;
  if (fs::exists(file)) {
    if (access(path.c_str(), W_OK) == 0) return {};
    const int reason = errno;
    // Another file takes the place of a regular one; the rest is written as it is.
    if (!fs::is_regular_file(fs::symlink_status(path, error))) {
      return CannotBeWritten(path, Reason(reason));
    }
  } else {
    // A link makes the file that it names.
    constexpr int kMostLinks = 40;
    for (int i = 0; i < kMostLinks && fs::is_symlink(fs::symlink_status(target, error)); ++i) {
      target = target.parent_path() / fs::read_symlink(target, error);
    }
  }
  if (target.filename().empty()) return CannotBeWritten(path, "there is no name of a file");
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  if (access((folder / ".").c_str(), W_OK | X_OK) == 0) return {};
  return CannotBeWritten(path, Reason(errno));
}

TextPlace PlaceAt(std::string_view text, std::size_t offset) {
  TextPlace place;
  std::size_t start = 0;
  const std::size_t end = std::min(offset, text.size());
  for (std::size_t at = 0; at < end; ++at) {
    if (text[at] != '\n' && (text[at] != '\r' || text.substr(at + 1, 1) == "\n")) continue;
    ++place.line;
    start = at + 1;
  }
  std::string_view before = text.substr(start, end - start);
  if (before.ends_with('\r')) before.remove_suffix(1);  // between the two of CRLF
  const auto begins = [](char c) { return (static_cast<unsigned char>(c) & 0xc0U) != 0x80; };
  place.column += static_cast<std::size_t>(std::count_if(before.begin(), before.end(), begins));
  return place;
}

OutputFile::OutputFile(std::string path)
    : path_(std::move(path)), standard_(path_ == kStandardStream) {
  if (standard_) return;
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
  if (standard_) {
    errno = 0;
    if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size()) return {};
    return CannotWrite("standard output");
  }
  if (file_) errno = 0;  // else the reason is that of the opening, or of the write that failed
  file_ << text;
  if (!file_) return CannotWrite(path_);
  return {};
}

Status OutputFile::Close() {
  if (standard_) {
    errno = 0;
    if (std::fflush(stdout) == 0) return {};
    return CannotWrite("standard output");
  }
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
