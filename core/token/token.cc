#include "core/token/token.h"

#include "core/base/names.h"
#include "core/base/try.h"
#include "core/token/digest.h"

namespace arap {
namespace {

constexpr std::string_view kPrefix = "arapd_";

}  // namespace

std::optional<TokenParts> SplitToken(std::string_view token) {
  constexpr std::size_t kSecretAt = kPrefix.size() + kTokenIdDigits + 1;
  if (token.size() != kSecretAt + kTokenSecretDigits || !token.starts_with(kPrefix) ||
      token[kSecretAt - 1] != '_') {
    return std::nullopt;
  }
  const TokenParts parts{token.substr(kPrefix.size(), kTokenIdDigits), token.substr(kSecretAt)};
  if (!IsHex(parts.id, kTokenIdDigits) || !IsHex(parts.secret, kTokenSecretDigits)) {
    return std::nullopt;
  }
  return parts;
}

Result<std::string> HashSecret(std::string_view salt, std::string_view secret) {
  Sha256 hash;
  hash.Bytes(salt.data(), salt.size());
  hash.Bytes(secret.data(), secret.size());
  return hash.Hex();
}

Result<NewToken> MakeToken() {
  NewToken token;
  TRY(token.id, RandomHex(kTokenIdDigits));
  TRY(token.salt, RandomHex(kTokenSaltDigits));
  TRY(const std::string secret, RandomHex(kTokenSecretDigits));
  TRY(token.sha256, HashSecret(token.salt, secret));
  token.text = std::string(kPrefix) + token.id + "_" + secret;
  return token;
}

}  // namespace arap
