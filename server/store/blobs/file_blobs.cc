#include "server/store/blobs/file_blobs.h"

#include <cerrno>
#include <utility>
#include <vector>

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/files.h"
#include "core/base/names.h"
#include "core/base/try.h"
#include "core/token/digest.h"
#include "server/store/store.h"

namespace arap::store {
namespace {

bool IsHash(std::string_view name) { return IsHex(name, 64); }

// The names in a folder, in no order.
int Names(const std::string& folder, std::vector<std::string>& names) {
  const std::unique_ptr<DIR, int (*)(DIR*)> directory(opendir(folder.c_str()), &closedir);
  if (directory == nullptr) return errno;
  errno = 0;
  // Safe: nobody else reads this stream.
  while (const dirent* entry = readdir(directory.get())) {  // NOLINT(concurrency-mt-unsafe)
    names.emplace_back(static_cast<const char*>(entry->d_name));
  }
  return errno;
}

bool IsOld(const struct stat& info, std::chrono::seconds age) {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  return now.tv_sec - info.st_mtim.tv_sec > age.count() ||
         (now.tv_sec - info.st_mtim.tv_sec == age.count() && now.tv_nsec >= info.st_mtim.tv_nsec);
}

// The size of a regular file; EINVAL for anything else, which no store has made.
int Size(const File& file, std::size_t& size) {
  struct stat info {};
  if (fstat(file.fd(), &info) != 0) return errno;
  if (!S_ISREG(info.st_mode)) return EINVAL;
  size = static_cast<std::size_t>(info.st_size);
  return 0;
}

}  // namespace

Result<std::unique_ptr<FileBlobStore>> FileBlobStore::Open(const std::string& root) {
  std::unique_ptr<FileBlobStore> store(new FileBlobStore(root));
  int error = MakeDirectory(root);
  if (error == 0) error = MakeDirectory(store->TmpPath());
  FileLock lock;
  if (error == 0) error = FileLock::Take(store->LockPath(), FileLock::Kind::kShared, true, lock);
  if (error != 0) {
    Fault fault = UnavailableErrno(error);
    fault.message = fmt::format("{}: {}", root, fault.message);
    return Fail(fault.Detail("directory", root));
  }
  return store;
}

std::string FileBlobStore::FolderOf(const std::string& hash) const {
  return root_ + "/" + hash.substr(0, 2) + "/" + hash.substr(2, 2);
}

// Sets the time of a blob to now, so that no sweep removes it; `good` says whether its bytes are
// the ones that were put.
int FileBlobStore::Refresh(const std::string& path, std::string_view bytes, bool& good) const {
  good = false;
  File file;
  std::size_t size = 0;
  if (OpenFile(path, O_RDONLY, file) != 0 || Size(file, size) != 0 || size != bytes.size()) {
    return 0;
  }
  std::string there;
  if (ReadAll(file, size, there) != 0 || there != bytes) return 0;
  if (futimens(file.fd(), nullptr) != 0) return errno;
  good = true;
  return 0;
}

int FileBlobStore::Write(const std::string& hash, std::string_view bytes) const {
  std::string tmp = TmpPath() + "/" + hash + ".XXXXXX";
  File file(mkostemp(tmp.data(), O_CLOEXEC));
  if (!file) return errno;
  int error = WriteAll(file, bytes);
  if (error == 0 && fsync(file.fd()) != 0) error = errno;
  if (error == 0) error = MakeDirectory(root_ + "/" + hash.substr(0, 2));
  if (error == 0) error = MakeDirectory(FolderOf(hash));
  // A sweep must not look at the old file under this name and remove the new one.
  FileLock lock;
  if (error == 0) error = FileLock::Take(LockPath(), FileLock::Kind::kShared, true, lock);
  if (error == 0) error = Rename(tmp, PathOf(hash));
  if (error != 0) {
    unlink(tmp.c_str());
    return error;
  }
  return 0;
}

// Makes the name of a blob durable, also one that another server, or one that was killed, has given
// but not yet flushed.
int FileBlobStore::SyncNames(const std::string& hash) const {
  int error = SyncDirectory(FolderOf(hash));
  if (error == 0) error = SyncDirectory(ParentOf(FolderOf(hash)));
  if (error == 0) error = SyncDirectory(root_);
  return error;
}

Status FileBlobStore::Put(const std::string& hash, std::string_view bytes) {
  if (!IsHash(hash)) return Fail(FaultKind::kInternal, "A blob is not named by a SHA-256.");
  bool good = false;
  int error = 0;
  {
    FileLock lock;
    error = FileLock::Take(LockPath(), FileLock::Kind::kShared, true, lock);
    if (error == 0) error = Refresh(PathOf(hash), bytes, good);
  }
  if (error == 0 && !good) error = Write(hash, bytes);
  if (error == 0) error = SyncNames(hash);
  if (error != 0) return Fail(UnavailableErrno(error));
  return {};
}

Result<std::string> FileBlobStore::Get(const std::string& hash) {
  if (!IsHash(hash)) return Fail(LostBlob(hash, "missing"));
  File file;
  int error = OpenFile(PathOf(hash), O_RDONLY, file);
  if (error == ENOENT || error == ENOTDIR) {
    // Without the folder of the store nothing is known about any blob.
    if (access(TmpPath().c_str(), F_OK) == 0) return Fail(LostBlob(hash, "missing"));
    return Fail(Unavailable("the folder of its blobs is not there"));
  }
  if (error == ELOOP) return Fail(LostBlob(hash, "damaged"));
  std::size_t size = 0;
  std::string bytes;
  if (error == 0) error = Size(file, size);
  if (error == 0) error = ReadAll(file, size, bytes);
  if (error == EINVAL || error == EIO) return Fail(LostBlob(hash, "damaged"));
  if (error != 0) return Fail(UnavailableErrno(error));
  TRY(const auto digest, Sha256Hex(bytes));
  if (digest != hash) return Fail(LostBlob(hash, "damaged"));
  return bytes;
}

// Looks again at the age under the lock, which keeps every Put out, and removes `path` if it is
// still old. `removed` says so.
int FileBlobStore::RemoveOld(const std::string& path, std::chrono::seconds age,
                             bool& removed) const {
  FileLock lock;
  const int error = FileLock::Take(LockPath(), FileLock::Kind::kExclusive, true, lock);
  if (error != 0) return error;
  struct stat info {};
  if (lstat(path.c_str(), &info) != 0 || !IsOld(info, age)) return 0;
  removed = unlink(path.c_str()) == 0;
  return removed || errno == ENOENT ? 0 : errno;
}

// Removes what is old and not in `referenced`; in tmp, where that is null, whatever is old.
int FileBlobStore::SweepFolder(const std::string& folder, const std::set<std::string>* referenced,
                               std::chrono::seconds age, SweepReport& report) const {
  std::vector<std::string> names;
  if (const int error = Names(folder, names); error != 0) return error == ENOENT ? 0 : error;
  int first_error = 0;
  for (const std::string& name : names) {
    const bool ours = referenced != nullptr ? IsHash(name) : IsHash(name.substr(0, 64));
    const std::string path = folder + "/" + name;
    struct stat info {};
    if (!ours || lstat(path.c_str(), &info) != 0 || !S_ISREG(info.st_mode)) continue;
    const auto bytes = static_cast<std::size_t>(info.st_size);
    bool removed = false;
    if (IsOld(info, age) && (referenced == nullptr || !referenced->contains(name))) {
      const int error = RemoveOld(path, age, removed);
      first_error = first_error == 0 ? error : first_error;
    }
    if (removed) {
      ++report.removed;
      report.removed_bytes += bytes;
    } else if (referenced != nullptr) {
      ++report.kept;
      report.kept_bytes += bytes;
    }
  }
  return first_error;
}

Result<SweepReport> FileBlobStore::Sweep(const std::set<std::string>& referenced,
                                         std::chrono::seconds age) {
  SweepReport report;
  int first_error = SweepFolder(TmpPath(), nullptr, age, report);
  std::vector<std::string> outer;
  if (const int error = Names(root_, outer); error != 0) return Fail(UnavailableErrno(error));
  for (const std::string& first : outer) {
    std::vector<std::string> inner;
    if (!IsHex(first, 2) || Names(root_ + "/" + first, inner) != 0) continue;
    for (const std::string& second : inner) {
      if (!IsHex(second, 2)) continue;
      const int error = SweepFolder(root_ + "/" + first + "/" + second, &referenced, age, report);
      first_error = first_error == 0 ? error : first_error;
    }
  }
  if (first_error != 0) return Fail(UnavailableErrno(first_error));
  return report;
}

}  // namespace arap::store
