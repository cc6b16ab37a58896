#include "server/access/tokens.h"

#include <cerrno>
#include <fstream>
#include <iterator>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <sys/stat.h>

#include "core/base/names.h"
#include "core/base/try.h"
#include "core/token/digest.h"
#include "core/token/token.h"

namespace arap::app {
namespace {

Role RoleOf(TokenRole role) {
  switch (role) {
    case TokenRole::kAdmin:
      return Role::kAdmin;
    case TokenRole::kGateway:
      return Role::kGateway;
    case TokenRole::kUser:
      break;
  }
  return Role::kUser;
}

// What an unknown id is compared with.
TokenFile::Entry NoEntry() {
  return {{}, {}, std::string(kTokenSaltDigits, '0'), std::string(kTokenSecretDigits, '0'), {}};
}

// Whether calls with the token can be this owner's.
bool HasOwner(const Caller& caller, std::string_view owner) {
  return caller.role == Role::kGateway ? BelongsTo(owner, caller.owner) : owner == caller.owner;
}

// In seconds: as the clock's nanoseconds, times after 2262 would overflow.
bool HasExpired(const TokenFile::Entry& entry, TokenFile::Wall now) {
  return entry.expires && *entry.expires <= std::chrono::floor<std::chrono::seconds>(now);
}

// Those that are stated, or else the defaults.
OwnerLimits LimitsOf(const std::map<std::string, std::uint64_t>& of_token, OwnerLimits limits) {
  for (const LimitInfo& info : kLimits) {
    const auto* const member = std::get_if<std::size_t OwnerLimits::*>(&info.member);
    const auto stated = of_token.find(std::string(TokenName(info)));
    if (member != nullptr && stated != of_token.end()) limits.** member = stated->second;
  }
  return limits;
}

Fault Unreadable(const std::string& path, const std::string& why) {
  Fault fault(FaultKind::kInvalidOption,
              fmt::format("The token file {} cannot be used: {}.", path, why));
  return fault.Detail("file", path);
}

Fault NoLonger() {
  return Fault(FaultKind::kUnauthenticated,
               "The bearer token of this call was revoked or has expired.");
}

}  // namespace

std::string_view TokenFile::IdOf(std::string_view token) {
  const auto parts = SplitToken(token);
  return parts ? parts->id : std::string_view();
}

Result<TokenFile> TokenFile::Parse(std::string_view json, const std::string& name,
                                   const OwnerLimits& defaults) {
  TRY(std::vector<TokenEntry> entries, ParseTokenFile(json, name));
  TokenFile file;
  for (TokenEntry& entry : entries) {
    const OwnerLimits limits = LimitsOf(entry.limits, defaults);
    Caller caller{std::move(entry.owner), RoleOf(entry.role), limits};
    if (caller.role == Role::kGateway) caller.gateway = Gateway{caller.owner, limits};
    file.entries_.emplace(std::move(entry.id),
                          Entry{std::move(caller), LimitsOf(entry.user_limits, defaults),
                                std::move(entry.salt), std::move(entry.sha256), entry.expires});
  }
  return file;
}

Result<TokenFile> TokenFile::Read(const std::string& path, const OwnerLimits& defaults) {
  struct stat info {};
  if (stat(path.c_str(), &info) != 0) {
    return Fail(Unreadable(path, std::generic_category().message(errno)));
  }
  if (!S_ISREG(info.st_mode)) return Fail(Unreadable(path, "it is not a regular file"));
  if ((info.st_mode & (S_IRWXO | S_IWGRP)) != 0) {
    return Fail(
        Unreadable(path,
                   "its mode lets others in; chmod 600 or 640 it, or in Kubernetes mount it "
                   "with defaultMode 0440 and an fsGroup"));
  }
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!file.is_open() || file.bad()) {
    return Fail(Unreadable(path, std::generic_category().message(errno)));
  }
  return Parse(text, path, defaults);
}

Result<Caller> TokenFile::Check(std::string_view token, Wall now,
                                const std::optional<std::string>& user) const {
  const auto parts = SplitToken(token);
  if (!parts) return Fail(FaultKind::kUnauthenticated, "The bearer token is not one of arapd's.");
  const auto found = entries_.find(parts->id);
  const bool known = found != entries_.end();
  const Entry entry = known ? found->second : NoEntry();
  TRY(const std::string digest, HashSecret(entry.salt, parts->secret));
  const bool same = SameDigest(digest, entry.sha256);
  if (!known || !same) {
    return Fail(FaultKind::kUnauthenticated, "This server does not know the bearer token.");
  }
  if (HasExpired(entry, now)) {
    return Fail(FaultKind::kUnauthenticated, "The bearer token has expired.");
  }
  if (!user) return entry.caller;
  if (entry.caller.role != Role::kGateway) {
    return Fail(FaultKind::kPermissionDenied,
                "The header x-arapd-owner is for tokens with the role gateway.");
  }
  CHECK_OK(CheckName(*user, "x-arapd-owner"));
  Caller caller = entry.caller;
  caller.owner += "/" + *user;
  caller.role = Role::kUser;
  caller.limits = entry.user_limits;
  return caller;
}

bool TokenFile::Holds(std::string_view id, std::string_view owner, Wall now) const {
  const auto found = entries_.find(id);
  return found != entries_.end() && HasOwner(found->second.caller, owner) &&
         !HasExpired(found->second, now);
}

Tokens::Tokens(std::string path, const OwnerLimits& defaults, const runtime::Clock& clock)
    : path_(std::move(path)), defaults_(defaults), clock_(clock) {}

Result<std::shared_ptr<Tokens>> Tokens::Open(std::string path, const OwnerLimits& defaults,
                                             const runtime::Clock& clock) {
  std::shared_ptr<Tokens> tokens(new Tokens(std::move(path), defaults, clock));
  CHECK_OK(tokens->Reload());
  return tokens;
}

Result<Caller> Tokens::Check(std::string_view token, const std::optional<std::string>& user) const {
  std::shared_ptr<const TokenFile> file;
  {
    const MutexLock lock(&mutex_);
    file = file_;
  }
  return file->Check(token, clock_.WallNow(), user);
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
