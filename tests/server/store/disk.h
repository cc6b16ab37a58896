// Disks that fail: full ones and read-only ones, for real.
#pragma once

#include <string>

#include <sys/resource.h>

#include "tests/server/store/temp_dir.h"

namespace arap::testing {

// A small disk of its own. Only root can have one: ask mounted().
class TinyDisk {
 public:
  TinyDisk();
  ~TinyDisk();
  TinyDisk(const TinyDisk&) = delete;
  TinyDisk& operator=(const TinyDisk&) = delete;

  bool mounted() const { return mounted_; }
  const std::string& path() const { return dir_.path(); }
  void Fill();
  void Free();
  // False when it cannot be changed now.
  bool SetReadOnly(bool read_only);

 private:
  TempDir dir_;
  bool mounted_ = false;
};

// While it lives, no file of this process grows beyond `bytes`: works for everybody.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes);
  ~FileSizeLimit();
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
};

// Makes a file or a directory unchangeable even for root and for who has it open. False where the
// file system or our rights do not allow it.
bool SetImmutable(const std::string& path, bool immutable);

}  // namespace arap::testing
