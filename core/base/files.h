// Files: descriptors that close themselves, durable writes, and locks between processes.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include "arap/base/result.h"

namespace arap {

// Owns a file descriptor; -1 is none.
class File {
 public:
  File() = default;
  explicit File(int fd) : fd_(fd) {}
  File(File&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  File& operator=(File&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~File();

  int fd() const { return fd_; }
  explicit operator bool() const { return fd_ >= 0; }

 private:
  int fd_ = -1;
};

// All of these return 0 or an errno.

// Closed on exec; waits for nothing and follows no link in the last part of `path`.
int OpenFile(const std::string& path, int flags, File& file);
int WriteAll(const File& file, std::string_view bytes);
// `size` bytes from the start; fewer when the file ends before.
int ReadAll(const File& file, std::size_t size, std::string& bytes);
// Makes the names in a directory durable.
int SyncDirectory(const std::string& path);
// Makes the directory `path` with mode 0700, in a parent that is there, unless it exists. Durable
// after SyncDirectory of the parent.
int MakeDirectory(const std::string& path);
int Rename(const std::string& from, const std::string& to);
// The whole of a regular file; EINVAL for anything else.
int ReadWhole(const std::string& path, std::string& bytes);
// Puts a new file in the place of the one at `path` at once, so that no reader sees half of it.
// Durable when it returns. It has the mode 0600; where there was a file, that file's mode without
// what lets others in, and its owner and group as far as we may set them. Of writers that meet the
// last one wins: let them hold a FileLock from reading to replacing.
int ReplaceFile(const std::string& path, std::string_view bytes);

// Whether a directory lets everybody make and remove files in it.
bool OthersMayWrite(const std::string& directory);

// What stands before the last slash.
std::string ParentOf(const std::string& path);

// A lock on the file `path`, which is made when it is missing, against other processes and other
// locks in this one; ends with the object. The kernel ends it with the process.
class FileLock {
 public:
  enum class Kind { kShared, kExclusive };

  // EWOULDBLOCK when somebody holds it and `wait` is false.
  static int Take(const std::string& path, Kind kind, bool wait, FileLock& lock);
  // Exclusive; EWOULDBLOCK when somebody has held it for as long as the patience.
  static int TakeWithin(const std::string& path, std::chrono::milliseconds patience,
                        FileLock& lock);

 private:
  File file_;
};

}  // namespace arap
