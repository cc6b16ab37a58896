#include "server/store/blobs/blob_cache.h"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/files.h"
#include "core/base/names.h"
#include "core/token/digest.h"
#include "server/store/store.h"

namespace arap::store {
namespace {

namespace fs = std::filesystem;

struct Cached {
  fs::path path;
  fs::file_time_type used;
  std::size_t bytes = 0;
};

// What is in the folder by names of ours; what was being written when a server ended is removed.
std::vector<Cached> ListCached(const std::string& folder) {
  std::vector<Cached> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (!IsHex(name, 64)) {
      if (IsHex(name.substr(0, 64), 64)) fs::remove(entry.path(), error);
      continue;
    }
    const std::size_t size = entry.file_size(error);
    if (error || !entry.is_regular_file(error)) continue;
    files.push_back({entry.path(), entry.last_write_time(error), size});
  }
  return files;
}

}  // namespace

struct BlobCache::Lock {
  FileLock file;
};

BlobCache::BlobCache(std::string folder, std::size_t most)
    : folder_(std::move(folder)), most_(most), lock_(std::make_unique<Lock>()) {}

BlobCache::~BlobCache() = default;

Result<std::unique_ptr<BlobCache>> BlobCache::Open(const std::string& folder, std::size_t most) {
  std::unique_ptr<BlobCache> cache(new BlobCache(folder, most));
  const auto fail = [&folder](Fault fault) {
    fault.message = fmt::format("{}: {}", folder, fault.message);
    return Fail(std::move(fault).Detail("directory", folder));
  };
  int error = MakeDirectory(folder);
  if (error == 0 && OthersMayWrite(folder)) {
    return fail(Unavailable("everybody may write into it; chmod o-w it"));
  }
  if (error == 0) {
    error = FileLock::Take(folder + "/lock", FileLock::Kind::kExclusive, false, cache->lock_->file);
  }
  if (error == EWOULDBLOCK) return fail(Unavailable("another server has its cache there"));
  if (error != 0) return fail(UnavailableErrno(error));
  const MutexLock lock(&cache->mutex_);
  for (const Cached& file : ListCached(folder)) cache->bytes_ += file.bytes;
  cache->MakeRoom(0);
  return cache;
}

std::size_t BlobCache::bytes() const {
  const MutexLock lock(&mutex_);
  return bytes_;
}

void BlobCache::MakeRoom(std::size_t more) {
  if (bytes_ + more <= most_) return;
  std::vector<Cached> files = ListCached(folder_);
  std::sort(files.begin(), files.end(),
            [](const Cached& a, const Cached& b) { return a.used < b.used; });
  bytes_ = 0;
  for (const Cached& file : files) bytes_ += file.bytes;
  // Some more than is needed, so that the folder is not looked through again at once.
  const std::size_t enough = most_ - most_ / 10;
  for (const Cached& file : files) {
    if (bytes_ + more <= enough || bytes_ == 0) return;
    std::error_code error;
    if (fs::remove(file.path, error)) bytes_ -= file.bytes;
  }
}

void BlobCache::Put(const std::string& hash, std::string_view bytes) {
  if (!IsHex(hash, 64) || bytes.size() > most_ / 2) return;
  const MutexLock lock(&mutex_);
  struct stat info {};
  if (stat(PathOf(hash).c_str(), &info) == 0) return;
  MakeRoom(bytes.size());
  std::string part = PathOf(hash) + ".XXXXXX";
  const File file(mkostemp(part.data(), O_CLOEXEC));
  if (!file) return;
  if (WriteAll(file, bytes) == 0 && rename(part.c_str(), PathOf(hash).c_str()) == 0) {
    bytes_ += bytes.size();
  } else {
    unlink(part.c_str());
  }
}

std::optional<std::string> BlobCache::Get(const std::string& hash) {
  if (!IsHex(hash, 64)) return std::nullopt;
  std::string bytes;
  if (ReadWhole(PathOf(hash), bytes) != 0) return std::nullopt;
  const auto digest = Sha256Hex(bytes);
  if (digest && *digest == hash) {
    utimensat(AT_FDCWD, PathOf(hash).c_str(), nullptr, AT_SYMLINK_NOFOLLOW);
    return bytes;
  }
  const MutexLock lock(&mutex_);
  if (unlink(PathOf(hash).c_str()) == 0) bytes_ -= std::min(bytes_, bytes.size());
  return std::nullopt;
}

}  // namespace arap::store
