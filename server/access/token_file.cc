#include "server/access/token_file.h"

#include <cerrno>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <sys/stat.h>

#include "core/base/try.h"
#include "core/token/sha256.h"
#include "core/token/token.h"
#include "server/access/token_entry.h"

namespace arap::app {
namespace {

// What an unknown id is compared with.
const TokenFile::Entry& Nobody() {
  static const TokenFile::Entry kNoEntry{
      {}, std::string(kTokenSaltDigits, '0'), std::string(kTokenSecretDigits, '0'), {}};
  return kNoEntry;
}

Fault Unreadable(const std::string& path, const std::string& why) {
  Fault fault(FaultKind::kInvalidOption,
              fmt::format("The token file {} cannot be used: {}.", path, why));
  return fault.Detail("file", path);
}

}  // namespace

std::string_view TokenFile::IdOf(std::string_view token) {
  const auto parts = SplitToken(token);
  return parts ? parts->id : std::string_view();
}

Result<TokenFile> TokenFile::Parse(std::string_view json, const std::string& name,
                                   const OwnerLimits& defaults) {
  auto entries = ParseTokenEntries(json, name, defaults);
  if (!entries) return Fail(std::move(entries.error()));
  TokenFile file;
  file.entries_ = *std::move(entries);
  return file;
}

Result<TokenFile> TokenFile::Read(const std::string& path, const OwnerLimits& defaults) {
  struct stat info {};
  if (stat(path.c_str(), &info) != 0) {
    return Fail(Unreadable(path, std::generic_category().message(errno)));
  }
  if (!S_ISREG(info.st_mode)) return Fail(Unreadable(path, "it is not a regular file"));
  if ((info.st_mode & (S_IRWXO | S_IWGRP)) != 0) {
    return Fail(Unreadable(path, "its mode lets others in; chmod 600 or 640 it"));
  }
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!file.is_open() || file.bad()) {
    return Fail(Unreadable(path, std::generic_category().message(errno)));
  }
  return Parse(text, path, defaults);
}

Result<Caller> TokenFile::Check(std::string_view token, Wall now) const {
  const auto parts = SplitToken(token);
  if (!parts) return Fail(FaultKind::kUnauthenticated, "The bearer token is not one of arapd's.");
  const auto found = entries_.find(parts->id);
  const bool known = found != entries_.end();
  const Entry& entry = known ? found->second : Nobody();
  TRY(const std::string digest, HashSecret(entry.salt, parts->secret));
  const bool same = SameDigest(digest, entry.sha256);
  if (!known || !same) {
    return Fail(FaultKind::kUnauthenticated, "This server does not know the bearer token.");
  }
  if (entry.expires && *entry.expires <= now) {
    return Fail(FaultKind::kUnauthenticated, "The bearer token has expired.");
  }
  return entry.caller;
}

bool TokenFile::Holds(std::string_view id, std::string_view owner, Wall now) const {
  const auto found = entries_.find(id);
  return found != entries_.end() && found->second.caller.owner == owner &&
         !(found->second.expires && *found->second.expires <= now);
}

}  // namespace arap::app
