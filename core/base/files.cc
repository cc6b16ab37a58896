#include "core/base/files.h"

#include <cerrno>

#include <fcntl.h>
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

}  // namespace arap
