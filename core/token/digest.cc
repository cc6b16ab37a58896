#include "core/token/digest.h"

#include <array>
#include <span>
#include <vector>

#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/rand.h>

#include "core/base/names.h"

namespace arap {
namespace {

Fault NoDigest() { return Fault(FaultKind::kInternal, "A digest could not be computed."); }

}  // namespace

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
  if (!good_) return Fail(NoDigest());
  return arap::Hex(std::span(digest).first(size));
}

Result<std::string> Sha256Hex(std::string_view bytes) {
  Sha256 hash;
  hash.Bytes(bytes.data(), bytes.size());
  return hash.Hex();
}

Result<std::string> Sha1Hex(std::string_view bytes) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), &size, EVP_sha1(), nullptr) != 1) {
    return Fail(NoDigest());
  }
  return Hex(std::span(digest).first(size));
}

bool SameDigest(std::string_view a, std::string_view b) {
  return a.size() == b.size() && CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

Result<std::string> RandomHex(std::size_t digits) {
  std::vector<unsigned char> bytes(digits / 2);
  if (RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) != 1) {
    return Fail(FaultKind::kInternal, "The system gives no random numbers.");
  }
  return Hex(bytes);
}

}  // namespace arap
