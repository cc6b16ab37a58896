// Tokens: who may come with which bearer token — a token file as it was read, and the one in force,
// which can be replaced while the server runs.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "arap/base/result.h"
#include "core/base/mutex.h"
#include "server/access/caller.h"
#include "server/runtime/clock.h"

namespace arap::app {

// What the file said when it was read. Immutable, so thread-safe. The form of tokens and of the
// file: core/token.
class TokenFile {
 public:
  using Wall = std::chrono::system_clock::time_point;

  // The id of a token, empty for a text that is none. Looks at its form only.
  static std::string_view IdOf(std::string_view token);

  // `name` is the file's, for messages; `defaults` are the limits that an entry does not state.
  // kInvalidOption with the file, the entry (counted from 0) and the field. Nothing of a salt or a
  // hash is ever in a message. Two entries may have one owner, but not one id.
  static Result<TokenFile> Parse(std::string_view json, const std::string& name,
                                 const OwnerLimits& defaults);
  // Also refuses a file that others than its owner and its group may read, or others than its owner
  // may write: kInvalidOption, as for one that cannot be read.
  static Result<TokenFile> Read(const std::string& path, const OwnerLimits& defaults);

  // Whose token this is; kUnauthenticated for one of the wrong form, that is not in the file or has
  // expired. With a `user` it has to be a gateway's, and the caller is that user of the gateway:
  // kPermissionDenied for another role, kInvalidName for what is no name. Costs one digest, whether
  // the id is known or not, and compares in constant time.
  Result<Caller> Check(std::string_view token, Wall now,
                       const std::optional<std::string>& user = {}) const;

  // Whether the token of this id is still `owner`'s, or that of its gateway, and has not expired.
  bool Holds(std::string_view id, std::string_view owner, Wall now) const;

  std::size_t size() const { return entries_.size(); }

  struct Entry {
    Caller caller;
    OwnerLimits user_limits;  // of a gateway
    std::string salt;
    std::string sha256;
    std::optional<std::chrono::sys_seconds> expires;
  };

 private:
  std::map<std::string, Entry, std::less<>> entries_;  // by id
};

class TokenWatch;

// Thread-safe. Make it with Open; it lives as long as the last watch.
class Tokens : public std::enable_shared_from_this<Tokens> {
 public:
  using Lost = std::function<void(Fault)>;

  // Faults as TokenFile::Read. `clock` outlives it.
  static Result<std::shared_ptr<Tokens>> Open(std::string path, const OwnerLimits& defaults,
                                              const runtime::Clock& clock);

  // As TokenFile::Check, now.
  Result<Caller> Check(std::string_view token, const std::optional<std::string>& user = {}) const;

  // Reads the file again. Calls from then on are judged by it, and whoever is watched under a token
  // that it does not hold any more is told. When it cannot be used its fault is answered and the
  // tokens stay as they were.
  Status Reload();

  // To be called every few seconds: reloads if the file has changed since it was looked at, and
  // tells those whose token has expired. True if a new file is in force. The fault of a file that
  // cannot be used is answered once for each change of it.
  Result<bool> Refresh();

  // For calls that last: `lost` runs with kUnauthenticated, once, in the thread that reloads or
  // refreshes, when the token `id` does not belong to `owner` any more; in this one if that is so
  // already. It must not block. Nothing is promised after the watch is gone but that no new run
  // begins: let `lost` hold what it touches.
  TokenWatch Watch(std::string_view id, const std::string& owner, Lost lost);

  std::size_t size() const;

 private:
  friend class TokenWatch;
  struct Watched {
    std::string id;
    std::string owner;
    Lost lost;
  };
  // What tells one state of a file from another.
  struct Stamp {
    std::uint64_t device = 0, inode = 0, size = 0, seconds = 0, nanos = 0;
    bool operator==(const Stamp&) const = default;
  };

  Tokens(std::string path, const OwnerLimits& defaults, const runtime::Clock& clock);
  static Stamp StampOf(const std::string& path);
  // Ends the watches whose token does not hold any more.
  void EndLostWatches();
  void Forget(std::uint64_t key);

  const std::string path_;
  const OwnerLimits defaults_;
  const runtime::Clock& clock_;
  Mutex reload_mutex_;  // one reload at a time, so that the newest file wins

  mutable Mutex mutex_;
  std::shared_ptr<const TokenFile> file_ ABSL_GUARDED_BY(mutex_);
  Stamp stamp_ ABSL_GUARDED_BY(mutex_);
  std::uint64_t next_key_ ABSL_GUARDED_BY(mutex_) = 1;
  std::map<std::uint64_t, Watched> watched_ ABSL_GUARDED_BY(mutex_);
};

// Ends its watch when it goes. An empty one watches nothing. Move-only.
class TokenWatch {
 public:
  TokenWatch() = default;
  TokenWatch(TokenWatch&& other) noexcept { *this = std::move(other); }
  TokenWatch& operator=(TokenWatch&& other) noexcept {
    std::swap(tokens_, other.tokens_);
    std::swap(key_, other.key_);
    return *this;
  }
  ~TokenWatch() {
    if (tokens_) tokens_->Forget(key_);
  }

 private:
  friend class Tokens;
  TokenWatch(std::shared_ptr<Tokens> tokens, std::uint64_t key)
      : tokens_(std::move(tokens)), key_(key) {}

  std::shared_ptr<Tokens> tokens_;
  std::uint64_t key_ = 0;
};

}  // namespace arap::app
