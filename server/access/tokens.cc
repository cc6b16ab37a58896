#include "server/access/tokens.h"

#include <vector>

#include <sys/stat.h>

#include "core/base/try.h"

namespace arap::app {
namespace {

Fault NoLonger() {
  return Fault(FaultKind::kUnauthenticated,
               "The bearer token of this call was revoked or has expired.");
}

}  // namespace

Tokens::Tokens(std::string path, const OwnerLimits& defaults, const runtime::Clock& clock)
    : path_(std::move(path)), defaults_(defaults), clock_(clock) {}

Result<std::shared_ptr<Tokens>> Tokens::Open(std::string path, const OwnerLimits& defaults,
                                             const runtime::Clock& clock) {
  std::shared_ptr<Tokens> tokens(new Tokens(std::move(path), defaults, clock));
  CHECK_OK(tokens->Reload());
  return tokens;
}

Result<Caller> Tokens::Check(std::string_view token) const {
  std::shared_ptr<const TokenFile> file;
  {
    const MutexLock lock(&mutex_);
    file = file_;
  }
  return file->Check(token, clock_.WallNow());
}

Status Tokens::Reload() {
  const MutexLock one_at_a_time(&reload_mutex_);
  // Before reading: a change in between is seen by the next look.
  const Stamp stamp = StampOf(path_);
  auto file = TokenFile::Read(path_, defaults_);
  {
    const MutexLock lock(&mutex_);
    stamp_ = stamp;
    if (!file) return Fail(std::move(file.error()));
    file_ = std::make_shared<const TokenFile>(*std::move(file));
  }
  EndLostWatches();
  return {};
}

Result<bool> Tokens::Refresh() {
  const Stamp now = StampOf(path_);
  bool changed = false;
  {
    const MutexLock lock(&mutex_);
    changed = !(now == stamp_);
  }
  const Status loaded = changed ? Reload() : Status();
  // Tokens expire whether the file is good or not.
  EndLostWatches();
  if (!loaded) return Fail(loaded.error());
  return changed;
}

TokenWatch Tokens::Watch(std::string_view id, const std::string& owner, Lost lost) {
  {
    const MutexLock lock(&mutex_);
    if (file_->Holds(id, owner, clock_.WallNow())) {
      const std::uint64_t key = next_key_++;
      watched_.emplace(key, Watched{std::string(id), owner, std::move(lost)});
      return {shared_from_this(), key};
    }
  }
  lost(NoLonger());
  return {};
}

std::size_t Tokens::size() const {
  const MutexLock lock(&mutex_);
  return file_->size();
}

Tokens::Stamp Tokens::StampOf(const std::string& path) {
  struct stat info {};
  if (stat(path.c_str(), &info) != 0) return {};
  return {info.st_dev, info.st_ino, static_cast<std::uint64_t>(info.st_size),
          static_cast<std::uint64_t>(info.st_ctim.tv_sec),
          static_cast<std::uint64_t>(info.st_ctim.tv_nsec)};
}

void Tokens::EndLostWatches() {
  std::vector<Lost> lost;
  {
    const MutexLock lock(&mutex_);
    const auto now = clock_.WallNow();
    for (auto at = watched_.begin(); at != watched_.end();) {
      Watched& watched = at->second;
      if (file_->Holds(watched.id, watched.owner, now)) {
        ++at;
        continue;
      }
      lost.push_back(std::move(watched.lost));
      at = watched_.erase(at);
    }
  }
  for (const Lost& tell : lost) tell(NoLonger());
}

void Tokens::Forget(std::uint64_t key) {
  const MutexLock lock(&mutex_);
  watched_.erase(key);
}

}  // namespace arap::app
