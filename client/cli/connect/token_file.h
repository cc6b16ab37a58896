// The server's token files, written from here. The format is the server's
// (server/access/token_file.h); the file holds salted hashes, never a token.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "arap/base/result.h"

namespace arap::cli {

struct TokenEntry {
  std::string id;  // 32 hexadecimal digits
  std::string owner;
  std::string role = "user";  // or "admin"
  std::string salt;
  std::string sha256;
  std::string expires;  // "2027-01-31T00:00:00Z"; empty: never
  std::map<std::string, std::uint64_t> limits;
};

struct NewToken {
  std::string text;  // the token itself: shown once, kept nowhere
  TokenEntry entry;
};

// An entry with fresh random bits for its id, salt and secret. kInternal when the system has none.
Result<NewToken> MakeToken(std::string owner);

// The time that many days from now, as in TokenEntry::expires.
std::string ExpiryAfter(int days);

// No entries for a file that is not there, unless `must_exist`. kInvalidOption for one that is no
// token file.
Result<std::vector<TokenEntry>> ReadTokenFile(const std::string& path, bool must_exist);
// A new file takes the place of the old one at once, so that no reader sees half of it. It has the
// mode 0600, or, where there was one, that of the old file without what lets others in, and its
// owner and group as far as we may set them. Two writers at a time: the last one wins.
Status WriteTokenFile(const std::string& path, const std::vector<TokenEntry>& entries);

}  // namespace arap::cli
