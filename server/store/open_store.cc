#include "server/store/open_store.h"

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/base/files.h"
#include "core/base/try.h"
#include "server/runtime/clock.h"
#include "server/store/blobs/file_blobs.h"
#include "server/store/blobs/s3_blobs.h"
#include "server/store/memory_store.h"
#include "server/store/redis/redis.h"
#include "server/store/redis/redis_store.h"
#include "server/store/redis/redis_url.h"
#include "server/store/sqlite/sqlite_store.h"
#include "server/store/store.h"

namespace arap::store {
namespace {

constexpr std::string_view kSqlite = "sqlite:";

Fault Malformed(std::string message, std::string field) {
  return Fault(FaultKind::kInvalidOption, std::move(message)).Field(std::move(field));
}

std::string WithoutSlash(std::string path) {
  while (path.size() > 1 && path.back() == '/') path.pop_back();
  return path;
}

// The options as the object store wants them.
Result<S3Options> S3OptionsOf(const StoreOptions& options) {
  const S3Flags& flags = options.s3;
  S3Options s3;
  CHECK_OK(ParseS3Url(options.blob_store, s3));
  s3.region = flags.region;
  s3.endpoint =
      WithoutSlash(flags.endpoint.empty() ? fmt::format("https://s3.{}.amazonaws.com", flags.region)
                                          : flags.endpoint);
  s3.credentials_file = flags.credentials_file;
  s3.key_id = flags.key_id;
  s3.secret = flags.secret;
  s3.session_token = flags.session_token;
  s3.ca = flags.ca;
  return s3;
}

Status CheckS3(const StoreOptions& options) {
  const S3Flags& flags = options.s3;
  if (options.blob_store.empty()) {
    if (flags.credentials_file.empty() && flags.endpoint.empty()) return {};
    return Fail(Malformed("It is for --blob-store s3://….",
                          flags.endpoint.empty() ? "s3_credentials_file" : "s3_endpoint"));
  }
  if (options.store == "memory") {
    return Fail(Malformed("With --store memory there are no blobs to keep.", "blob_store"));
  }
  const auto is_plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
  };
  if (flags.region.empty() || !std::all_of(flags.region.begin(), flags.region.end(), is_plain)) {
    return Fail(Malformed("A region is small letters, digits and hyphens.", "s3_region"));
  }
  TRY(S3Options s3, S3OptionsOf(options));
  const std::size_t scheme = s3.endpoint.find("://");
  const std::string host = scheme == std::string::npos ? "" : s3.endpoint.substr(scheme + 3);
  if ((!s3.endpoint.starts_with("http://") && !s3.endpoint.starts_with("https://")) ||
      host.empty() || host.find_first_of("/?#@ ") != std::string::npos) {
    return Fail(Malformed("It is not of the form https://HOST[:PORT].", "s3_endpoint"));
  }
  if (!s3.credentials_file.empty()) return ReadS3Credentials(s3.credentials_file, s3);
  if (!s3.key_id.empty() && !s3.secret.empty()) return {};
  return Fail(
      Malformed("It is needed with --blob-store, or AWS_ACCESS_KEY_ID and "
                "AWS_SECRET_ACCESS_KEY in the environment.",
                "s3_credentials_file"));
}

Status AddBlobs(const StoreOptions& options, const std::string& directory, Stores& stores) {
  if (!options.blob_store.empty()) {
    TRY(S3Options s3, S3OptionsOf(options));
    std::unique_ptr<BlobCache> cache;
    if (!options.blob_dir.empty() && options.s3.cache_bytes > 0) {
      TRY(cache, BlobCache::Open(WithoutSlash(options.blob_dir), options.s3.cache_bytes));
    }
    stores.blobs = std::make_unique<S3BlobStore>(std::move(s3), std::move(cache));
    return {};
  }
  TRY(auto blobs, FileBlobStore::Open(directory));
  stores.blobs = std::move(blobs);
  return {};
}

// Refuses a store that says that it loses what it acknowledges, and blobs that are another store's,
// unless losses are allowed. What cannot be reached yet is asked later (store_keeper.h).
Status CheckFacts(const StoreOptions& options, Stores& stores) {
  stores.allow_lossy = options.allow_lossy;
  if (options.allow_lossy) return {};
  const auto facts = stores.specs->Facts();
  if (!facts) return {};
  for (const Weakness& weakness : facts->weaknesses) {
    if (!weakness.grave) continue;
    return Fail(FaultKind::kStoreUnavailable,
                weakness.sentence + " If that may be so, start with --allow-lossy-store.");
  }
  return stores.blobs->Claim(facts->id);
}

Result<Stores> OpenSqlite(const StoreOptions& options) {
  const std::string directory = WithoutSlash(options.store.substr(kSqlite.size()));
  if (const int error = MakeDirectory(directory); error != 0) {
    Fault fault = UnavailableErrno(error);
    fault.message = fmt::format("{}: {}", directory, fault.message);
    return Fail(fault.Detail("directory", directory));
  }
  if (OthersMayWrite(directory)) {
    return Fail(
        Unavailable(fmt::format("everybody may write into its folder {}; chmod o-w it", directory))
            .Detail("directory", directory));
  }
  TRY(auto specs, SqliteSpecStore::Open(directory, options.on_recovery));
  Stores stores;
  stores.recovery = specs->recovery();
  stores.specs = std::move(specs);
  const std::string blobs =
      options.blob_dir.empty() ? directory + "/blobs" : WithoutSlash(options.blob_dir);
  CHECK_OK(AddBlobs(options, blobs, stores));
  CHECK_OK(CheckFacts(options, stores));
  return stores;
}

// The options as Redis wants them.
Result<RedisOptions> RedisOptionsOf(const StoreOptions& options) {
  RedisOptions redis;
  TRY(redis.url, ParseRedisUrl(options.store));
  const RedisFlags& flags = options.redis;
  redis.sentinel_password = flags.sentinel_password;
  redis.replicas = flags.replicas;
  if (redis.url.access.tls) redis.url.access.tls = RedisTls{flags.ca, flags.certificate, flags.key};
  return redis;
}

Status CheckRedisFlags(const RedisFlags& flags, const std::optional<RedisUrl>& url) {
  const bool tls = url && url->access.tls;
  for (const auto& [field, file] :
       {std::pair{"redis_ca", flags.ca}, std::pair{"redis_cert", flags.certificate},
        std::pair{"redis_key", flags.key}}) {
    if (file.empty() || tls) continue;
    return Fail(Malformed("It is for rediss://…, which --store is not.", field));
  }
  if (flags.certificate.empty() != flags.key.empty()) {
    return Fail(Malformed("--redis-cert and --redis-key go together.",
                          flags.key.empty() ? "redis_cert" : "redis_key"));
  }
  if (!flags.sentinel_password.empty() && (!url || url->kind != RedisUrl::Kind::kSentinels)) {
    return Fail(Malformed("It is for redis+sentinel://…, which --store is not.",
                          "redis_sentinel_password_file"));
  }
  if (flags.replicas > 0 && !url) {
    return Fail(Malformed("It is for redis://…, which --store is not.", "redis_replicas"));
  }
  if (tls) return CheckTls({flags.ca, flags.certificate, flags.key});
  return {};
}

Result<Stores> OpenRedis(const StoreOptions& options) {
  TRY(const RedisOptions redis, RedisOptionsOf(options));
  Stores stores;
  stores.specs = std::make_unique<RedisSpecStore>(redis);
  CHECK_OK(AddBlobs(options, WithoutSlash(options.blob_dir), stores));
  CHECK_OK(CheckFacts(options, stores));
  return stores;
}

template <class Call>
auto Timed(runtime::Metrics& metrics, const char* operation, const Call& call) {
  const runtime::WallTimer time;
  auto answer = call();
  metrics.Store(operation, time.Micros() * 1e-6, answer.has_value());
  return answer;
}

class MeasuredSpecs final : public SpecStore {
 public:
  MeasuredSpecs(std::unique_ptr<SpecStore> store, runtime::Metrics& metrics)
      : store_(std::move(store)), metrics_(metrics) {}

  Result<std::optional<SessionRecord>> Load(const SessionKey& key) override {
    return Timed(metrics_, "load", [&] { return store_->Load(key); });
  }
  Result<std::optional<RecordVersion>> Version(const SessionKey& key) override {
    return Timed(metrics_, "version", [&] { return store_->Version(key); });
  }
  Result<bool> Put(const SessionRecord& record) override {
    return Timed(metrics_, "put", [&] { return store_->Put(record); });
  }
  Result<bool> Extend(const SessionKey& key, const std::string& incarnation,
                      runtime::Clock::Wall expires) override {
    return Timed(metrics_, "extend", [&] { return store_->Extend(key, incarnation, expires); });
  }
  Result<bool> Remove(const SessionKey& key) override {
    return Timed(metrics_, "remove", [&] { return store_->Remove(key); });
  }
  Result<bool> RemoveAsOf(const SessionKey& key, runtime::Clock::Wall expires) override {
    return Timed(metrics_, "remove", [&] { return store_->RemoveAsOf(key, expires); });
  }
  Result<std::vector<SessionRecord>> List(const std::string& owner, const std::string& after,
                                          std::size_t limit) override {
    return Timed(metrics_, "list", [&] { return store_->List(owner, after, limit); });
  }
  Result<std::vector<std::string>> Owners() override {
    return Timed(metrics_, "owners", [&] { return store_->Owners(); });
  }
  Result<Usage> UsageOf(const std::string& owner) override {
    return Timed(metrics_, "usage", [&] { return store_->UsageOf(owner); });
  }
  Result<Usage> UsageUnder(const std::string& owner) override {
    return Timed(metrics_, "usage", [&] { return store_->UsageUnder(owner); });
  }
  Result<std::size_t> Count() override {
    return Timed(metrics_, "count", [&] { return store_->Count(); });
  }
  Result<std::vector<SessionKey>> RemoveExpired(runtime::Clock::Wall now,
                                                std::size_t limit) override {
    return Timed(metrics_, "remove_expired", [&] { return store_->RemoveExpired(now, limit); });
  }
  Status Shift(std::chrono::milliseconds by) override {
    return Timed(metrics_, "shift", [&] { return store_->Shift(by); });
  }
  Result<std::set<std::string>> ReferencedBlobs() override {
    return Timed(metrics_, "referenced_blobs", [&] { return store_->ReferencedBlobs(); });
  }
  Result<std::optional<runtime::Clock::Wall>> Time() override {
    return Timed(metrics_, "time", [&] { return store_->Time(); });
  }
  Result<StoreFacts> Facts() override {
    return Timed(metrics_, "facts", [&] { return store_->Facts(); });
  }
  bool shared() const override { return store_->shared(); }
  Status Probe() override {
    return Timed(metrics_, "probe", [&] { return store_->Probe(); });
  }

 private:
  const std::unique_ptr<SpecStore> store_;
  runtime::Metrics& metrics_;
};

class MeasuredBlobs final : public BlobStore {
 public:
  MeasuredBlobs(std::unique_ptr<BlobStore> store, runtime::Metrics& metrics)
      : store_(std::move(store)), metrics_(metrics) {}

  Status Put(const std::string& hash, std::string_view bytes) override {
    return Timed(metrics_, "blob_put", [&] { return store_->Put(hash, bytes); });
  }
  Result<std::string> Get(const std::string& hash) override {
    return Timed(metrics_, "blob_get", [&] { return store_->Get(hash); });
  }
  Result<SweepReport> Sweep(const std::set<std::string>& referenced,
                            const SweepRules& rules) override {
    return Timed(metrics_, "blob_sweep", [&] { return store_->Sweep(referenced, rules); });
  }
  Status Claim(const std::string& store_id) override {
    return Timed(metrics_, "blob_claim", [&] { return store_->Claim(store_id); });
  }

 private:
  const std::unique_ptr<BlobStore> store_;
  runtime::Metrics& metrics_;
};

}  // namespace

Status CheckStore(const StoreOptions& options) {
  const std::string& store = options.store;
  CHECK_OK(CheckS3(options));
  if (NamesRedis(store)) {
    TRY(const RedisUrl url, ParseRedisUrl(store));
    CHECK_OK(CheckRedisFlags(options.redis, url));
    if (!options.blob_dir.empty() || !options.blob_store.empty()) return {};
    return Fail(
        Malformed("With redis, --blob-dir is needed, a folder for the meshes that all replicas "
                  "share, or --blob-store.",
                  "blob_dir"));
  }
  CHECK_OK(CheckRedisFlags(options.redis, std::nullopt));
  if (store == "memory" || (store.starts_with(kSqlite) && store.size() > kSqlite.size())) return {};
  return Fail(Malformed(fmt::format("--store {} is none of memory, sqlite:DIR and "
                                    "redis://[USER[:PASSWORD]@]HOST[:PORT][/DB].",
                                    StoreForLog(options)),
                        "store"));
}

Result<Stores> OpenStores(const StoreOptions& options) {
  CHECK_OK(CheckStore(options));
  if (options.store.starts_with(kSqlite)) return OpenSqlite(options);
  if (NamesRedis(options.store)) return OpenRedis(options);
  Stores stores;
  stores.specs = std::make_unique<MemorySpecStore>();
  stores.blobs = std::make_unique<MemoryBlobStore>();
  return stores;
}

std::string StoreForLog(const StoreOptions& options) { return WithoutPassword(options.store); }

Stores Measured(Stores stores, runtime::Metrics& metrics) {
  stores.specs = std::make_unique<MeasuredSpecs>(std::move(stores.specs), metrics);
  stores.blobs = std::make_unique<MeasuredBlobs>(std::move(stores.blobs), metrics);
  return stores;
}

}  // namespace arap::store
