// FileBlobStore: one file per blob, named by its digest.
#pragma once

#include <chrono>
#include <cstddef>
#include <ctime>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "server/store/store.h"

namespace arap {
class FileLock;
}

namespace arap::store {

//   ROOT/ab/cd/abcd…   a blob; the folders are the first four digits of its name
//   ROOT/tmp/          what is being written
//   ROOT/aside/        blobs that no record named: Get brings them back, a later sweep removes them
//   ROOT/store-id      the id of the store that these are the blobs of
//   ROOT/lock          taken for moments, so that no sweep removes what was just put
//
// Ages are measured by the clock of the file system alone, so that the clocks of the servers may
// differ.
//
// Several servers may share a ROOT. Blobs are written under tmp, flushed, renamed, and their folder
// is flushed; so a name is there with all its bytes or not at all. Files and folders that have
// other names are not touched. What Get returns has the digest it is named by: about 1 ms per MB
// to read and check.
class FileBlobStore final : public BlobStore {
 public:
  // Makes the folders that are missing below `root`, whose parent has to be there.
  // kStoreUnavailable, naming the directory, when that cannot be.
  static Result<std::unique_ptr<FileBlobStore>> Open(const std::string& root);

  // kInternal when `hash` is not 64 lower-case hexadecimal digits.
  Status Put(const std::string& hash, std::string_view bytes) override;
  Result<std::string> Get(const std::string& hash) override;
  Result<SweepReport> Sweep(const std::set<std::string>& referenced,
                            const SweepRules& rules) override;
  // Also kStoreUnavailable. A folder without an id becomes this store's.
  Status Claim(const std::string& store_id) override;

 private:
  struct Entry {
    std::string path;
    std::string name;
    std::size_t bytes = 0;
    bool old = false;
  };

  explicit FileBlobStore(std::string root) : root_(std::move(root)) {}

  std::string FolderOf(const std::string& hash) const;
  std::string PathOf(const std::string& hash) const { return FolderOf(hash) + "/" + hash; }
  std::string TmpPath() const { return root_ + "/tmp"; }
  std::string AsidePath() const { return root_ + "/aside"; }
  std::string IdPath() const { return root_ + "/store-id"; }
  std::string LockPath() const { return root_ + "/lock"; }

  // 0 or an errno, as in files.h.
  int Refresh(const std::string& path, std::string_view bytes, bool& good) const;
  int Write(const std::string& hash, std::string_view bytes) const;
  int SyncNames(const std::string& hash) const;
  int Now(timespec& now) const;
  int List(const std::string& folder, const timespec& now, std::chrono::seconds age,
           std::vector<Entry>& entries) const;
  int ListPlaces(const timespec& now, std::chrono::seconds age, std::vector<Entry>& entries) const;
  // Takes the lock, which keeps every Put out, and looks at the age again under it.
  int LockOld(const Entry& entry, std::chrono::seconds age, FileLock& lock, bool& old) const;
  int Remove(const Entry& entry, std::chrono::seconds age, SweepReport& report) const;
  int SetAside(const Entry& entry, std::chrono::seconds age, SweepReport& report) const;
  int BringBack(const std::string& hash) const;

  const std::string root_;
};

}  // namespace arap::store
