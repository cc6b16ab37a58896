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

bool IsOld(const struct stat& info, const timespec& now, std::chrono::seconds age) {
  const auto passed = now.tv_sec - info.st_mtim.tv_sec;
  return passed > age.count() || (passed == age.count() && now.tv_nsec >= info.st_mtim.tv_nsec);
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
  if (error == 0 && OthersMayWrite(root)) {
    return Fail(
        Unavailable(fmt::format("everybody may write into its folder {}; chmod o-w it", root))
            .Detail("directory", root));
  }
  if (error == 0) error = MakeDirectory(store->TmpPath());
  if (error == 0) error = MakeDirectory(store->AsidePath());
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
  if (error == ENOENT) {
    // Whether we or another call brings it back; on a disk that is read-only it stays aside.
    BringBack(hash);
    error = OpenFile(PathOf(hash), O_RDONLY, file);
    if (error == ENOENT) error = OpenFile(AsidePath() + "/" + hash, O_RDONLY, file);
  }
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

Status FileBlobStore::Claim(const std::string& store_id) {
  // One after the other, so that of two stores one is second.
  FileLock lock;
  int error = FileLock::Take(LockPath(), FileLock::Kind::kExclusive, true, lock);
  std::string there;
  if (error == 0) error = ReadWhole(IdPath(), there);
  if (error == ENOENT) {
    there = store_id;
    error = ReplaceFile(IdPath(), store_id);
  }
  if (error != 0) return Fail(UnavailableErrno(error));
  if (there == store_id) return {};
  return Fail(Fault(FaultKind::kInvalidOption,
                    fmt::format("The blobs in {} belong to another store of sessions ({}), not to "
                                "this one ({}): one that was emptied, or is not the one that was "
                                "meant. If they are to be this one's from now on, remove {}.",
                                root_, there, store_id, IdPath()))
                  .Field("blob_dir")
                  .Detail("directory", root_));
}

// By the clock that gives files their times, which need not be ours.
int FileBlobStore::Now(timespec& now) const {
  File file;
  if (const int error = OpenFile(LockPath(), O_RDONLY | O_CREAT, file); error != 0) return error;
  struct stat info {};
  if (futimens(file.fd(), nullptr) != 0 || fstat(file.fd(), &info) != 0) return errno;
  now = info.st_mtim;
  return 0;
}

// The files in a folder whose names begin with a digest.
int FileBlobStore::List(const std::string& folder, const timespec& now, std::chrono::seconds age,
                        std::vector<Entry>& entries) const {
  std::vector<std::string> names;
  if (const int error = Names(folder, names); error != 0) return error == ENOENT ? 0 : error;
  for (std::string& name : names) {
    std::string path = folder + "/" + name;
    struct stat info {};
    if (!IsHash(name.substr(0, 64)) || lstat(path.c_str(), &info) != 0) continue;
    if (!S_ISREG(info.st_mode)) continue;
    entries.push_back({std::move(path), std::move(name), static_cast<std::size_t>(info.st_size),
                       IsOld(info, now, age)});
  }
  return 0;
}

// The blobs that are in their places.
int FileBlobStore::ListPlaces(const timespec& now, std::chrono::seconds age,
                              std::vector<Entry>& entries) const {
  std::vector<std::string> outer;
  if (const int error = Names(root_, outer); error != 0) return error;
  for (const std::string& first : outer) {
    std::vector<std::string> inner;
    if (!IsHex(first, 2) || Names(root_ + "/" + first, inner) != 0) continue;
    for (const std::string& second : inner) {
      if (!IsHex(second, 2)) continue;
      const std::string folder = root_ + "/" + first + "/" + second;
      if (const int error = List(folder, now, age, entries); error != 0) return error;
    }
  }
  std::erase_if(entries, [](const Entry& entry) { return !IsHash(entry.name); });
  return 0;
}

int FileBlobStore::LockOld(const Entry& entry, std::chrono::seconds age, FileLock& lock,
                           bool& old) const {
  timespec now{};
  int error = FileLock::Take(LockPath(), FileLock::Kind::kExclusive, true, lock);
  if (error == 0) error = Now(now);
  if (error != 0) return error;
  struct stat info {};
  old = lstat(entry.path.c_str(), &info) == 0 && IsOld(info, now, age);
  return 0;
}

int FileBlobStore::Remove(const Entry& entry, std::chrono::seconds age, SweepReport& report) const {
  FileLock lock;
  bool old = false;
  if (const int error = LockOld(entry, age, lock, old); error != 0 || !old) return error;
  if (unlink(entry.path.c_str()) != 0) return errno == ENOENT ? 0 : errno;
  ++report.removed;
  report.removed_bytes += entry.bytes;
  return 0;
}

int FileBlobStore::SetAside(const Entry& entry, std::chrono::seconds age,
                            SweepReport& report) const {
  FileLock lock;
  bool old = false;
  int error = LockOld(entry, age, lock, old);
  if (error != 0 || !old) return error;
  // From now on it is counted how long it lies there.
  if (utimensat(AT_FDCWD, entry.path.c_str(), nullptr, AT_SYMLINK_NOFOLLOW) != 0) return errno;
  error = Rename(entry.path, AsidePath() + "/" + entry.name);
  if (error != 0) return error;
  --report.kept;
  report.kept_bytes -= entry.bytes;
  return 0;
}

// ENOENT when it does not lie aside. It is as young as a new one afterwards.
int FileBlobStore::BringBack(const std::string& hash) const {
  const std::string aside = AsidePath() + "/" + hash;
  if (access(aside.c_str(), F_OK) != 0) return errno;
  FileLock lock;
  int error = FileLock::Take(LockPath(), FileLock::Kind::kShared, true, lock);
  if (error == 0) error = MakeDirectory(root_ + "/" + hash.substr(0, 2));
  if (error == 0) error = MakeDirectory(FolderOf(hash));
  if (error != 0) return error;
  if (utimensat(AT_FDCWD, aside.c_str(), nullptr, AT_SYMLINK_NOFOLLOW) != 0) return errno;
  return Rename(aside, PathOf(hash));
}

Result<SweepReport> FileBlobStore::Sweep(const std::set<std::string>& referenced,
                                         const SweepRules& rules) {
  SweepReport report;
  std::vector<Entry> left, places, aside;
  timespec now{};
  int error = Now(now);
  if (error == 0) error = List(TmpPath(), now, rules.age, left);
  if (error == 0) error = ListPlaces(now, rules.age, places);
  if (error != 0) return Fail(UnavailableErrno(error));
  // One file that cannot be moved or removed does not keep the others.
  const auto note = [&error](int another) { error = error == 0 ? another : error; };
  for (const Entry& entry : left) {
    if (entry.old) note(Remove(entry, rules.age, report));
  }
  std::vector<const Entry*> unnamed;
  for (const Entry& entry : places) {
    ++report.kept;
    report.kept_bytes += entry.bytes;
    if (entry.old && !referenced.contains(entry.name)) unnamed.push_back(&entry);
  }
  const auto count = static_cast<double>(unnamed.size());
  if (unnamed.size() > rules.few && count > rules.share * static_cast<double>(places.size())) {
    report.held_back = unnamed.size();
  } else {
    for (const Entry* entry : unnamed) note(SetAside(*entry, rules.age, report));
  }
  // Later than the times of those that were just set aside.
  note(Now(now));
  note(List(AsidePath(), now, rules.aside, aside));
  for (const Entry& entry : aside) {
    if (referenced.contains(entry.name)) {
      note(BringBack(entry.name));
    } else if (entry.old) {
      note(Remove(entry, rules.aside, report));
    } else {
      ++report.aside;
    }
  }
  if (error != 0) return Fail(UnavailableErrno(error));
  return report;
}

}  // namespace arap::store
