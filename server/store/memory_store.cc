#include "server/store/memory_store.h"

#include <utility>

#include "core/base/try.h"
#include "server/store/store.h"

namespace arap::store {
namespace {

Usage UsageOfRecord(const SessionRecord& record) {
  return {1, record.meshes.size(), record.handle_sets.size(), record.BlobBytes()};
}

}  // namespace

Result<std::optional<SessionRecord>> MemorySpecStore::Load(const SessionKey& key) {
  const MutexLock lock(&mutex_);
  const auto found = records_.find(key);
  if (found == records_.end()) return std::nullopt;
  return found->second;
}

Result<std::optional<RecordVersion>> MemorySpecStore::Version(const SessionKey& key) {
  const MutexLock lock(&mutex_);
  const auto found = records_.find(key);
  if (found == records_.end()) return std::nullopt;
  return VersionOf(found->second);
}

Result<bool> MemorySpecStore::Put(const SessionRecord& record) {
  const MutexLock lock(&mutex_);
  const auto found = records_.find(record.key);
  const std::uint64_t before = found == records_.end() ? 0 : found->second.revision;
  if (before + 1 != record.revision) return false;
  if (before > 0 && found->second.incarnation != record.incarnation) return false;
  records_.insert_or_assign(record.key, record);
  return true;
}

Result<bool> MemorySpecStore::Extend(const SessionKey& key, const std::string& incarnation,
                                     runtime::Clock::Wall expires) {
  const MutexLock lock(&mutex_);
  const auto found = records_.find(key);
  if (found == records_.end() || found->second.incarnation != incarnation) return false;
  found->second.expires = expires;
  return true;
}

Result<bool> MemorySpecStore::Remove(const SessionKey& key) {
  const MutexLock lock(&mutex_);
  return records_.erase(key) > 0;
}

Result<bool> MemorySpecStore::RemoveAsOf(const SessionKey& key, runtime::Clock::Wall expires) {
  const MutexLock lock(&mutex_);
  const auto found = records_.find(key);
  if (found == records_.end() || found->second.expires != expires) return false;
  records_.erase(found);
  return true;
}

Result<std::vector<SessionRecord>> MemorySpecStore::List(const std::string& owner,
                                                         const std::string& after,
                                                         std::size_t limit) {
  const MutexLock lock(&mutex_);
  std::vector<SessionRecord> records;
  for (auto at = records_.upper_bound({owner, after});
       at != records_.end() && at->first.owner == owner && records.size() < limit; ++at) {
    records.push_back(at->second);
  }
  return records;
}

Result<std::vector<std::string>> MemorySpecStore::Owners() {
  const MutexLock lock(&mutex_);
  std::vector<std::string> owners;
  for (const auto& [key, record] : records_) {
    if (owners.empty() || owners.back() != key.owner) owners.push_back(key.owner);
  }
  return owners;
}

Result<Usage> MemorySpecStore::UsageOf(const std::string& owner) {
  const MutexLock lock(&mutex_);
  Usage usage;
  for (auto at = records_.lower_bound({owner, ""});
       at != records_.end() && at->first.owner == owner; ++at) {
    usage += UsageOfRecord(at->second);
  }
  return usage;
}

Result<Usage> MemorySpecStore::UsageUnder(const std::string& owner) {
  TRY(Usage usage, UsageOf(owner));
  const MutexLock lock(&mutex_);
  const std::string under = owner + "/";
  for (auto at = records_.lower_bound({under, ""});
       at != records_.end() && at->first.owner.starts_with(under); ++at) {
    usage += UsageOfRecord(at->second);
  }
  return usage;
}

Result<std::size_t> MemorySpecStore::Count() {
  const MutexLock lock(&mutex_);
  return records_.size();
}

Result<std::vector<SessionKey>> MemorySpecStore::RemoveExpired(runtime::Clock::Wall now,
                                                               std::size_t limit) {
  const MutexLock lock(&mutex_);
  std::vector<SessionKey> removed;
  for (auto at = records_.begin(); at != records_.end() && removed.size() < limit;) {
    if (at->second.expires > now) {
      ++at;
      continue;
    }
    removed.push_back(at->first);
    at = records_.erase(at);
  }
  return removed;
}

Status MemorySpecStore::Shift(std::chrono::milliseconds by) {
  const MutexLock lock(&mutex_);
  for (auto& [key, record] : records_) record.expires += by;
  return {};
}

Result<std::set<std::string>> MemorySpecStore::ReferencedBlobs() {
  const MutexLock lock(&mutex_);
  std::set<std::string> blobs;
  for (const auto& [key, record] : records_) {
    blobs.merge(record.Blobs());
  }
  return blobs;
}

Status MemoryBlobStore::Put(const std::string& hash, std::string_view bytes) {
  const MutexLock lock(&mutex_);
  Blob& blob = blobs_[hash];
  if (blob.bytes.size() != bytes.size()) blob.bytes = bytes;
  blob.put = std::chrono::steady_clock::now();
  return {};
}

Result<std::string> MemoryBlobStore::Get(const std::string& hash) {
  const MutexLock lock(&mutex_);
  const auto found = blobs_.find(hash);
  if (found != blobs_.end()) return found->second.bytes;
  return Fail(LostBlob(hash, "missing"));
}

Result<SweepReport> MemoryBlobStore::Sweep(const std::set<std::string>& referenced,
                                           const SweepRules& rules) {
  const MutexLock lock(&mutex_);
  const auto now = std::chrono::steady_clock::now();
  SweepReport report;
  for (auto at = blobs_.begin(); at != blobs_.end();) {
    const std::size_t bytes = at->second.bytes.size();
    if (referenced.contains(at->first) || now - at->second.put < rules.age) {
      ++report.kept;
      report.kept_bytes += bytes;
      ++at;
    } else {
      ++report.removed;
      report.removed_bytes += bytes;
      at = blobs_.erase(at);
    }
  }
  return report;
}

}  // namespace arap::store
