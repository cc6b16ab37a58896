#include "core/token/sha256.h"

#include <array>
#include <span>

#include <openssl/crypto.h>
#include <openssl/evp.h>

#include "core/base/hex.h"

namespace arap {

Sha256::Sha256() : context_(EVP_MD_CTX_new(), &EVP_MD_CTX_free) {
  good_ = context_ != nullptr && EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1;
}

void Sha256::Bytes(const void* data, std::size_t size) {
  good_ = good_ && EVP_DigestUpdate(context_.get(), data, size) == 1;
}

Result<std::string> Sha256::Hex() {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  good_ = good_ && EVP_DigestFinal_ex(context_.get(), digest.data(), &size) == 1;
  if (!good_) return Fail(FaultKind::kInternal, "A SHA-256 digest could not be computed.");
  return arap::Hex(std::span(digest).first(size));
}

Result<std::string> Sha256Hex(std::string_view bytes) {
  Sha256 hash;
  hash.Bytes(bytes.data(), bytes.size());
  return hash.Hex();
}

bool SameDigest(std::string_view a, std::string_view b) {
  return a.size() == b.size() && CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

}  // namespace arap
