// Stores in memory: everything ends with the process.
#pragma once

#include <chrono>
#include <map>
#include <string>

#include "core/base/mutex.h"
#include "server/store/store.h"

namespace arap::store {

class MemorySpecStore : public SpecStore {
 public:
  Result<std::optional<SessionRecord>> Load(const SessionKey& key) override;
  Result<std::optional<RecordVersion>> Version(const SessionKey& key) override;
  Result<bool> Put(const SessionRecord& record) override;
  Result<bool> Extend(const SessionKey& key, const std::string& incarnation,
                      runtime::Clock::Wall expires) override;
  Result<bool> Remove(const SessionKey& key) override;
  Result<bool> RemoveAsOf(const SessionKey& key, runtime::Clock::Wall expires) override;
  Result<std::vector<SessionRecord>> List(const std::string& owner, const std::string& after,
                                          std::size_t limit) override;
  Result<std::vector<std::string>> Owners() override;
  Result<Usage> UsageOf(const std::string& owner) override;
  Result<Usage> UsageUnder(const std::string& owner) override;
  Result<std::size_t> Count() override;
  Result<std::vector<SessionKey>> RemoveExpired(runtime::Clock::Wall now,
                                                std::size_t limit) override;
  Status Shift(std::chrono::milliseconds by) override;
  Result<std::set<std::string>> ReferencedBlobs() override;
  Result<std::optional<runtime::Clock::Wall>> Time() override { return std::nullopt; }
  Result<StoreFacts> Facts() override { return StoreFacts{"memory", {}}; }
  bool shared() const override { return false; }
  Status Probe() override { return {}; }

 private:
  Mutex mutex_;
  std::map<SessionKey, SessionRecord> records_ ABSL_GUARDED_BY(mutex_);
};

// Removes at once what a sweep takes away: it ends with its records, and nobody else has either.
class MemoryBlobStore final : public BlobStore {
 public:
  Status Put(const std::string& hash, std::string_view bytes) override;
  Result<std::string> Get(const std::string& hash) override;
  Result<SweepReport> Sweep(const std::set<std::string>& referenced,
                            const SweepRules& rules) override;
  Status Claim(const std::string&) override { return {}; }

 private:
  struct Blob {
    std::string bytes;
    std::chrono::steady_clock::time_point put;
  };
  Mutex mutex_;
  std::map<std::string, Blob> blobs_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace arap::store
