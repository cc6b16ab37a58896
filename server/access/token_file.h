// TokenFile: who may come with which bearer token.
// The form of tokens and of the file: core/token.
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "arap/base/result.h"
#include "server/access/caller.h"

namespace arap::app {

// Immutable, so thread-safe.
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
  // expired. Costs one digest, whether the id is known or not, and compares in constant time.
  Result<Caller> Check(std::string_view token, Wall now) const;

  // Whether the token of this id is still `owner`'s and has not expired.
  bool Holds(std::string_view id, std::string_view owner, Wall now) const;

  std::size_t size() const { return entries_.size(); }

  struct Entry {
    Caller caller;
    std::string salt;
    std::string sha256;
    std::optional<std::chrono::sys_seconds> expires;
  };

 private:
  std::map<std::string, Entry, std::less<>> entries_;  // by id
};

}  // namespace arap::app
