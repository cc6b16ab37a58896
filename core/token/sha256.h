// Sha256: the digest that keeps tokens and names stored blobs.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include <openssl/types.h>

#include "arap/base/result.h"

namespace arap {

// Not thread-safe. Takes bytes as they come.
class Sha256 {
 public:
  Sha256();
  void Bytes(const void* data, std::size_t size);
  // 64 lower-case hexadecimal digits; nothing can be added afterwards. kInternal if the library
  // failed.
  Result<std::string> Hex();

 private:
  std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> context_;
  bool good_ = false;
};

Result<std::string> Sha256Hex(std::string_view bytes);

// Whether two digests are equal. The time it takes says nothing about where they differ.
bool SameDigest(std::string_view a, std::string_view b);

}  // namespace arap
