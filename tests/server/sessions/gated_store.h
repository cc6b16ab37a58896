// GatedStore: a store in memory that holds one call up until the test lets it go on.
#pragma once

#include <chrono>
#include <optional>

#include <gtest/gtest.h>

#include "core/base/mutex.h"
#include "server/store/memory_store.h"
#include "tests/support/bounded.h"

namespace arap::testing {

class GatedStore final : public store::MemorySpecStore {
 public:
  enum class Call { kLoad, kPut, kExtend, kRemove };

  // The next such call on the session is held up: a Load when it has its answer, the others before
  // they change anything.
  void HoldUp(Call call, const store::SessionKey& key) {
    const MutexLock lock(&mutex_);
    awaited_ = {call, key};
    held_ = open_ = false;
  }
  // Waits for that call.
  void AwaitHeldCall() {
    const MutexLock lock(&mutex_);
    const auto deadline = std::chrono::steady_clock::now() + kLongest;
    while (!held_) {
      if (changed_.WaitUntil(&mutex_, deadline)) break;
    }
    EXPECT_TRUE(held_) << "waited for the call that is to be held up";
  }
  void LetGo() {
    const MutexLock lock(&mutex_);
    open_ = true;
    changed_.SignalAll();
  }

  // The next so many calls of Put find that another process was first.
  void Forestall(int puts) {
    const MutexLock lock(&mutex_);
    forestalled_ = puts;
  }
  // How many of them have not come.
  int forestalled() {
    const MutexLock lock(&mutex_);
    return forestalled_;
  }

  Result<std::optional<store::SessionRecord>> Load(const store::SessionKey& key) override {
    auto record = MemorySpecStore::Load(key);
    Pass(Call::kLoad, key);
    return record;
  }
  Result<bool> Put(const store::SessionRecord& record) override {
    Pass(Call::kPut, record.key);
    return Forestall() ? false : MemorySpecStore::Put(record);
  }
  Result<bool> Extend(const store::SessionKey& key, const std::string& incarnation,
                      runtime::Clock::Wall expires) override {
    Pass(Call::kExtend, key);
    return MemorySpecStore::Extend(key, incarnation, expires);
  }
  Result<bool> RemoveAsOf(const store::SessionKey& key, runtime::Clock::Wall expires) override {
    Pass(Call::kRemove, key);
    return MemorySpecStore::RemoveAsOf(key, expires);
  }
  Result<bool> Remove(const store::SessionKey& key) override {
    Pass(Call::kRemove, key);
    return MemorySpecStore::Remove(key);
  }

 private:
  struct Awaited {
    Call call;
    store::SessionKey key;
  };

  bool Forestall() {
    const MutexLock lock(&mutex_);
    if (forestalled_ == 0) return false;
    --forestalled_;
    return true;
  }

  void Pass(Call call, const store::SessionKey& key) {
    const MutexLock lock(&mutex_);
    if (!awaited_ || awaited_->call != call || awaited_->key != key) return;
    awaited_.reset();
    held_ = true;
    changed_.SignalAll();
    const auto deadline = std::chrono::steady_clock::now() + 2 * kLongest;
    while (!open_) {
      if (changed_.WaitUntil(&mutex_, deadline)) break;
    }
    EXPECT_TRUE(open_) << "waited for the test to let the call go on";
  }

  Mutex mutex_;
  CondVar changed_;
  std::optional<Awaited> awaited_ ABSL_GUARDED_BY(mutex_);
  bool held_ ABSL_GUARDED_BY(mutex_) = false;
  bool open_ ABSL_GUARDED_BY(mutex_) = false;
  int forestalled_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace arap::testing
