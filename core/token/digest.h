// Digests and random digits, from OpenSSL: what keeps tokens, names blobs and tells things apart.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include <openssl/types.h>

#include "arap/base/result.h"

namespace arap {

// Everything here answers in lower-case hexadecimal digits, and kInternal when the library fails.

// SHA-256 of bytes as they come. Not thread-safe.
class Sha256 {
 public:
  Sha256();
  void Bytes(const void* data, std::size_t size);
  // 64 digits; nothing can be added afterwards.
  Result<std::string> Hex();

 private:
  std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> context_;
  bool good_ = false;
};

// 64 digits.
Result<std::string> Sha256Hex(std::string_view bytes);
// 40 digits: the name that Redis has for a script. Protects nothing.
Result<std::string> Sha1Hex(std::string_view bytes);

// Whether two digests are equal. The time it takes says nothing about where they differ.
bool SameDigest(std::string_view a, std::string_view b);

// So many digits that nobody can guess; an even number of them.
Result<std::string> RandomHex(std::size_t digits);

}  // namespace arap
