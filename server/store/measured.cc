#include "server/store/measured.h"

#include <utility>

#include "server/runtime/stopwatch.h"

namespace arap::store {
namespace {

template <class Call>
auto Timed(runtime::Metrics& metrics, const char* operation, const Call& call) {
  const runtime::Stopwatch time;
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
  Result<std::optional<std::uint64_t>> Revision(const SessionKey& key) override {
    return Timed(metrics_, "revision", [&] { return store_->Revision(key); });
  }
  Result<bool> Put(const SessionRecord& record) override {
    return Timed(metrics_, "put", [&] { return store_->Put(record); });
  }
  Result<bool> Extend(const SessionKey& key, runtime::Clock::Wall expires) override {
    return Timed(metrics_, "extend", [&] { return store_->Extend(key, expires); });
  }
  Result<bool> Remove(const SessionKey& key) override {
    return Timed(metrics_, "remove", [&] { return store_->Remove(key); });
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
  Result<std::size_t> Count() override {
    return Timed(metrics_, "count", [&] { return store_->Count(); });
  }
  Result<std::vector<SessionKey>> RemoveExpired(runtime::Clock::Wall now,
                                                std::size_t limit) override {
    return Timed(metrics_, "remove_expired", [&] { return store_->RemoveExpired(now, limit); });
  }
  Result<std::set<std::string>> ReferencedBlobs() override {
    return Timed(metrics_, "referenced_blobs", [&] { return store_->ReferencedBlobs(); });
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
                            std::chrono::seconds age) override {
    return Timed(metrics_, "blob_sweep", [&] { return store_->Sweep(referenced, age); });
  }

 private:
  const std::unique_ptr<BlobStore> store_;
  runtime::Metrics& metrics_;
};

}  // namespace

Stores Measured(Stores stores, runtime::Metrics& metrics) {
  stores.specs = std::make_unique<MeasuredSpecs>(std::move(stores.specs), metrics);
  stores.blobs = std::make_unique<MeasuredBlobs>(std::move(stores.blobs), metrics);
  return stores;
}

}  // namespace arap::store
