#include "core/base/files.h"

#include <cerrno>
#include <cstdlib>

#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace arap {

File::~File() {
  if (fd_ >= 0) close(fd_);
}

int OpenFile(const std::string& path, int flags, File& file) {
  const int fd = open(path.c_str(), flags | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0600);
  if (fd < 0) return errno;
  file = File(fd);
  return 0;
}

int WriteAll(const File& file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(file.fd(), bytes.data(), bytes.size());
    if (written < 0 && errno != EINTR) return errno;
    if (written > 0) bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

int ReadAll(const File& file, std::size_t size, std::string& bytes) {
  bytes.resize(size);
  std::size_t done = 0;
  while (done < size) {
    const ssize_t got =
        pread(file.fd(), bytes.data() + done, size - done, static_cast<off_t>(done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return errno;
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  bytes.resize(done);
  return 0;
}

int SyncDirectory(const std::string& path) {
  File directory;
  if (const int error = OpenFile(path, O_RDONLY | O_DIRECTORY, directory); error != 0) return error;
  return fsync(directory.fd()) == 0 ? 0 : errno;
}

int MakeDirectory(const std::string& path) {
  if (mkdir(path.c_str(), 0700) == 0) return 0;
  if (errno != EEXIST) return errno;
  struct stat info {};
  if (stat(path.c_str(), &info) != 0) return errno;
  return S_ISDIR(info.st_mode) ? 0 : ENOTDIR;
}

int Rename(const std::string& from, const std::string& to) {
  return rename(from.c_str(), to.c_str()) == 0 ? 0 : errno;
}

int ReadWhole(const std::string& path, std::string& bytes) {
  File file;
  if (const int error = OpenFile(path, O_RDONLY, file); error != 0) return error;
  struct stat info {};
  if (fstat(file.fd(), &info) != 0) return errno;
  if (!S_ISREG(info.st_mode)) return EINVAL;
  return ReadAll(file, static_cast<std::size_t>(info.st_size), bytes);
}

namespace {

int CopyPermissions(const std::string& path, const File& fresh) {
  struct stat old {};
  if (stat(path.c_str(), &old) != 0) return 0;  // mkostemp made the new one 0600
  // Without the right to give files away it stays ours.
  if (fchown(fresh.fd(), old.st_uid, old.st_gid) != 0 && errno != EPERM) return errno;
  constexpr mode_t kOthers = S_IRWXO | S_IWGRP | S_IXGRP | S_IXUSR;
  return fchmod(fresh.fd(), old.st_mode & 0777 & ~kOthers) == 0 ? 0 : errno;
}

}  // namespace

int ReplaceFile(const std::string& path, std::string_view bytes) {
  std::string fresh = path + ".XXXXXX";
  const File file(mkostemp(fresh.data(), O_CLOEXEC));
  if (!file) return errno;
  int error = CopyPermissions(path, file);
  if (error == 0) error = WriteAll(file, bytes);
  if (error == 0 && fsync(file.fd()) != 0) error = errno;
  if (error == 0) error = Rename(fresh, path);
  if (error == 0) return SyncDirectory(ParentOf(path));
  unlink(fresh.c_str());
  return error;
}

bool OthersMayWrite(const std::string& directory) {
  struct stat info {};
  return stat(directory.c_str(), &info) == 0 && (info.st_mode & S_IWOTH) != 0;
}

std::string ParentOf(const std::string& path) {
  const std::size_t slash = path.find_last_of('/');
  if (slash == std::string::npos) return ".";
  return slash == 0 ? "/" : path.substr(0, slash);
}

int FileLock::Take(const std::string& path, Kind kind, bool wait, FileLock& lock) {
  File file;
  // A reader may hold a lock too, and then a directory that became read-only can still be locked.
  int error = OpenFile(path, O_RDONLY, file);
  if (error == ENOENT) error = OpenFile(path, O_RDONLY | O_CREAT, file);
  if (error != 0) return error;
  const int operation = (kind == Kind::kShared ? LOCK_SH : LOCK_EX) | (wait ? 0 : LOCK_NB);
  while (flock(file.fd(), operation) != 0) {
    if (errno != EINTR) return errno;
  }
  lock.file_ = std::move(file);
  return 0;
}

int FileLock::TakeWithin(const std::string& path, std::chrono::milliseconds patience,
                         FileLock& lock) {
  // The kernel has no wait with an end.
  constexpr int kLookEveryMs = 10;
  const auto end = std::chrono::steady_clock::now() + patience;
  for (;;) {
    const int error = Take(path, Kind::kExclusive, false, lock);
    if (error != EWOULDBLOCK || std::chrono::steady_clock::now() >= end) return error;
    poll(nullptr, 0, kLookEveryMs);
  }
}

}  // namespace arap
