// Bearer tokens. A token is the text "arapd_ID_SECRET": 32 lower-case hexadecimal digits that name
// an entry of the server's token file and 64 that prove it. The file keeps a salted hash of the
// secret (token_file.h). Secrets are 256 random bits, so one round of the hash is as good as many.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "arap/base/result.h"

namespace arap {

inline constexpr std::size_t kTokenIdDigits = 32;
inline constexpr std::size_t kTokenSaltDigits = 32;
inline constexpr std::size_t kTokenSecretDigits = 64;

struct TokenParts {
  std::string_view id;
  std::string_view secret;
};

// The parts of a token, as views of its text; nothing for a text that is no token. Looks at its
// form only.
std::optional<TokenParts> SplitToken(std::string_view token);

// What the file keeps of a secret: SHA-256 of the text of the salt followed by that of the secret,
// 64 digits. kInternal if it cannot be computed.
Result<std::string> HashSecret(std::string_view salt, std::string_view secret);

// A fresh token, and what its entry in the file says of it.
struct NewToken {
  std::string text;  // the token itself: shown once, kept nowhere
  std::string id;
  std::string salt;
  std::string sha256;
};

// Id, salt and secret are random. kInternal when the system has no random numbers.
Result<NewToken> MakeToken();

}  // namespace arap
