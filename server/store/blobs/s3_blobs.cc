#include "server/store/blobs/s3_blobs.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/base/names.h"
#include "core/base/try.h"
#include "core/token/digest.h"

namespace arap::store {
namespace {

constexpr const char* kBlobs = "blobs/";
constexpr const char* kAside = "aside/";
constexpr const char* kStoreId = "store-id";

// The digest that an object is named by; empty when it has another name, which no store has made.
std::string HashOf(const S3Object& object, std::string_view folder) {
  std::string name = object.key.substr(std::min(folder.size(), object.key.size()));
  return IsHex(name, 64) ? name : std::string();
}

}  // namespace

S3BlobStore::S3BlobStore(S3Options options, std::unique_ptr<BlobCache> cache,
                         std::chrono::seconds sweep_every)
    : client_(options),
      where_(fmt::format("s3://{}/{}", options.bucket, options.prefix)),
      cache_(std::move(cache)),
      sweep_every_(sweep_every) {}

// Also when it is there already: so it is young again.
Status S3BlobStore::Put(const std::string& hash, std::string_view bytes) {
  if (!IsHex(hash, 64)) return Fail(FaultKind::kInternal, "A blob is not named by a SHA-256.");
  CHECK_OK(client_.Put(kBlobs + hash, bytes, hash));
  if (cache_) cache_->Put(hash, bytes);
  return {};
}

// The object is in both places for a moment, and in neither never.
Status S3BlobStore::Move(const std::string& from, const std::string& to) {
  CHECK_OK(client_.Copy(from, to));
  return client_.Delete(from);
}

Result<std::string> S3BlobStore::Fetch(const std::string& hash) {
  auto bytes = client_.Get(kBlobs + hash);
  if (bytes || bytes.error().kind != FaultKind::kNotFound) return bytes;
  bytes = client_.Get(kAside + hash);
  if (bytes) {
    // Where it cannot be moved it stays aside, and is there all the same.
    static_cast<void>(Move(kAside + hash, kBlobs + hash));
  } else if (bytes.error().kind == FaultKind::kNotFound) {
    // Another server may have brought it back meanwhile.
    bytes = client_.Get(kBlobs + hash);
  }
  if (!bytes && bytes.error().kind == FaultKind::kNotFound) return Fail(LostBlob(hash, "missing"));
  return bytes;
}

Result<std::string> S3BlobStore::Get(const std::string& hash) {
  if (!IsHex(hash, 64)) return Fail(LostBlob(hash, "missing"));
  if (cache_) {
    if (auto cached = cache_->Get(hash)) return *std::move(cached);
  }
  TRY(std::string bytes, Fetch(hash));
  TRY(const auto digest, Sha256Hex(bytes));
  if (digest != hash) return Fail(LostBlob(hash, "damaged"));
  if (cache_) cache_->Put(hash, bytes);
  return bytes;
}

Status S3BlobStore::Claim(const std::string& store_id) {
  TRY(const std::string digest, Sha256Hex(store_id));
  auto there = client_.Get(kStoreId);
  if (!there && there.error().kind == FaultKind::kNotFound) {
    CHECK_OK(client_.Put(kStoreId, store_id, digest, true));
    // Of two that come at once one finds the other's, at the latest when it looks the next time.
    there = client_.Get(kStoreId);
  }
  if (!there) return Fail(there.error());
  if (*there == store_id) return {};
  // What stands there is another's text.
  const std::string other = IsHex(*there, 32) ? *there : "no id";
  return Fail(Fault(FaultKind::kInvalidOption,
                    fmt::format("The blobs in {} belong to another store of sessions ({}), not to "
                                "this one ({}): one that was emptied, or is not the one that was "
                                "meant. If they are to be this one's from now on, remove {}{}.",
                                where_, other, store_id, where_, kStoreId))
                  .Field("blob_store"));
}

Result<SweepReport> S3BlobStore::Sweep(const std::set<std::string>& referenced,
                                       const SweepRules& rules) {
  {
    const MutexLock lock(&mutex_);
    if (swept_ && clock_.SteadyNow() - *swept_ < sweep_every_) return last_;
    swept_ = clock_.SteadyNow();
  }
  TRY(SweepReport report, SweepNow(referenced, rules));
  const MutexLock lock(&mutex_);
  last_ = report;
  last_.removed = last_.removed_bytes = 0;
  return report;
}

Result<SweepReport> S3BlobStore::SweepNow(const std::set<std::string>& referenced,
                                          const SweepRules& rules) {
  SweepReport report;
  Status fault;
  // One object that cannot be moved or removed does not keep the others.
  const auto note = [&fault](const Status& done) {
    if (fault && !done && done.error().kind != FaultKind::kNotFound) fault = done;
    return done.has_value();
  };
  TRY(const S3List places, client_.List(kBlobs));
  std::vector<const S3Object*> unnamed;
  for (const S3Object& object : places.objects) {
    const std::string hash = HashOf(object, kBlobs);
    if (hash.empty()) continue;
    ++report.kept;
    report.kept_bytes += object.bytes;
    const bool old = places.now - object.modified >= rules.age.count();
    if (old && !referenced.contains(hash)) unnamed.push_back(&object);
  }
  const auto count = static_cast<double>(unnamed.size());
  if (unnamed.size() > rules.few && count > rules.share * static_cast<double>(report.kept)) {
    report.held_back = unnamed.size();
    unnamed.clear();
  }
  for (const S3Object* object : unnamed) {
    if (!note(Move(object->key, kAside + HashOf(*object, kBlobs)))) continue;
    --report.kept;
    report.kept_bytes -= object->bytes;
  }
  TRY(const S3List aside, client_.List(kAside));
  for (const S3Object& object : aside.objects) {
    const std::string hash = HashOf(object, kAside);
    if (hash.empty()) continue;
    if (referenced.contains(hash)) {
      note(Move(object.key, kBlobs + hash));
    } else if (aside.now - object.modified < rules.aside.count()) {
      ++report.aside;
    } else if (note(client_.Delete(object.key))) {
      ++report.removed;
      report.removed_bytes += object.bytes;
    }
  }
  if (!fault) return Fail(fault.error());
  return report;
}

}  // namespace arap::store
