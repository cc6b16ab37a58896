#include "server/access/token_file.h"

#include <cerrno>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <openssl/crypto.h>
#include <sys/stat.h>

#include "server/access/token_entry.h"
#include "server/runtime/sha256.h"

namespace arap::app {
namespace {

constexpr std::string_view kPrefix = "arapd_";

struct Parts {
  std::string_view id;
  std::string_view secret;
};

std::optional<Parts> Split(std::string_view token) {
  constexpr std::size_t kSecretAt = kPrefix.size() + kTokenIdDigits + 1;
  if (token.size() != kSecretAt + kTokenSecretDigits || !token.starts_with(kPrefix) ||
      token[kSecretAt - 1] != '_') {
    return std::nullopt;
  }
  const Parts parts{token.substr(kPrefix.size(), kTokenIdDigits), token.substr(kSecretAt)};
  if (!IsHex(parts.id, kTokenIdDigits) || !IsHex(parts.secret, kTokenSecretDigits)) {
    return std::nullopt;
  }
  return parts;
}

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
  const auto parts = Split(token);
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
  const auto parts = Split(token);
  if (!parts) return Fail(FaultKind::kUnauthenticated, "The bearer token is not one of arapd's.");
  const auto found = entries_.find(parts->id);
  const bool known = found != entries_.end();
  const Entry& entry = known ? found->second : Nobody();
  runtime::Sha256 hash;
  hash.Bytes(entry.salt.data(), entry.salt.size());
  hash.Bytes(parts->secret.data(), parts->secret.size());
  const auto digest = hash.Hex();
  if (!digest) return Fail(digest.error());
  const bool same = digest->size() == entry.sha256.size() &&
                    CRYPTO_memcmp(digest->data(), entry.sha256.data(), digest->size()) == 0;
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
