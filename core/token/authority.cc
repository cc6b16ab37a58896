#include "core/token/authority.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>
#include <utility>

#include <arpa/inet.h>
#include <openssl/bio.h>
#include <openssl/bn.h>
#include <openssl/ec.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509v3.h>

#include "core/base/try.h"

namespace arap {
namespace {

using Key = std::shared_ptr<EVP_PKEY>;
using Certificate = std::shared_ptr<X509>;

constexpr long kHour = 3'600;

Fault CannotCertify() {
  ERR_clear_error();
  return Fault(FaultKind::kInternal, "OpenSSL makes no certificate.");
}

// The text that `write` puts into a BIO; empty when it fails.
template <class Write>
std::string Pem(Write write) {
  const std::unique_ptr<BIO, int (*)(BIO*)> memory(BIO_new(BIO_s_mem()), &BIO_free);
  if (memory == nullptr || write(memory.get()) != 1) return {};
  char* data = nullptr;
  const long size = BIO_get_mem_data(memory.get(), &data);
  return {data, static_cast<std::size_t>(size)};
}

Result<Credential> PemOf(const Certificate& certificate, const Key& key) {
  Credential credential;
  credential.certificate =
      Pem([&](BIO* memory) { return PEM_write_bio_X509(memory, certificate.get()); });
  credential.key = Pem([&](BIO* memory) {
    return PEM_write_bio_PrivateKey(memory, key.get(), nullptr, nullptr, 0, nullptr, nullptr);
  });
  if (credential.certificate.empty() || credential.key.empty()) return Fail(CannotCertify());
  return credential;
}

// Of a name and a key, without issuer, extensions and signature.
Certificate Blank(const std::string& common_name, const Key& key, std::chrono::days life) {
  Certificate certificate(X509_new(), &X509_free);
  X509* const raw = certificate.get();
  const std::unique_ptr<BIGNUM, void (*)(BIGNUM*)> serial(BN_new(), &BN_free);
  constexpr int kSerialBits = 120;  // random, so that no two are equal
  const auto* const name = reinterpret_cast<const unsigned char*>(common_name.data());
  const bool good =
      raw != nullptr && serial != nullptr && X509_set_version(raw, X509_VERSION_3) == 1 &&
      BN_rand(serial.get(), kSerialBits, BN_RAND_TOP_ONE, BN_RAND_BOTTOM_ANY) == 1 &&
      BN_to_ASN1_INTEGER(serial.get(), X509_get_serialNumber(raw)) != nullptr &&
      X509_gmtime_adj(X509_getm_notBefore(raw), -kHour) != nullptr &&
      X509_time_adj_ex(X509_getm_notAfter(raw), static_cast<int>(life.count()), 0, nullptr) !=
          nullptr &&
      X509_set_pubkey(raw, key.get()) == 1 &&
      X509_NAME_add_entry_by_txt(X509_get_subject_name(raw), "CN", MBSTRING_UTF8, name,
                                 static_cast<int>(common_name.size()), -1, 0) == 1;
  return good ? certificate : nullptr;
}

bool Extend(const Certificate& certificate, const Certificate& issuer, int kind,
            const std::string& value) {
  X509V3_CTX context;
  X509V3_set_ctx(&context, issuer.get(), certificate.get(), nullptr, nullptr, 0);
  const std::unique_ptr<X509_EXTENSION, void (*)(X509_EXTENSION*)> extension(
      X509V3_EXT_conf_nid(nullptr, &context, kind, value.c_str()), &X509_EXTENSION_free);
  return extension != nullptr && X509_add_ext(certificate.get(), extension.get(), -1) == 1;
}

bool AreDigits(std::string_view label) {
  return std::all_of(label.begin(), label.end(),
                     [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; });
}

bool IsLabel(std::string_view label) {
  constexpr std::size_t kLongest = 63;
  const auto good = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-';
  };
  return !label.empty() && label.size() <= kLongest && label.front() != '-' &&
         label.back() != '-' && std::all_of(label.begin(), label.end(), good);
}

}  // namespace

bool IsAddress(const std::string& text) {
  std::array<unsigned char, sizeof(in6_addr)> address{};
  return inet_pton(AF_INET, text.c_str(), address.data()) == 1 ||
         inet_pton(AF_INET6, text.c_str(), address.data()) == 1;
}

bool IsHostName(const std::string& text) {
  constexpr std::size_t kLongest = 253;
  if (text.size() > kLongest) return false;
  std::string_view rest = text;
  if (rest.starts_with("*.")) rest.remove_prefix(2);
  for (bool more = true; more;) {
    const std::size_t dot = rest.find('.');
    if (!IsLabel(rest.substr(0, dot))) return false;
    more = dot != std::string_view::npos;
    // It would be an address, and is none.
    if (!more && AreDigits(rest)) return false;
    rest.remove_prefix(more ? dot + 1 : rest.size());
  }
  return true;
}

Result<Authority> Authority::Make(const std::string& name, std::chrono::days life) {
  const Key key(EVP_EC_gen("P-256"), &EVP_PKEY_free);
  const Certificate own = key == nullptr ? nullptr : Blank(name, key, life);
  const bool good = own != nullptr &&
                    X509_set_issuer_name(own.get(), X509_get_subject_name(own.get())) == 1 &&
                    // It vouches for no further authority.
                    Extend(own, own, NID_basic_constraints, "critical,CA:TRUE,pathlen:0") &&
                    Extend(own, own, NID_key_usage, "critical,keyCertSign,cRLSign") &&
                    Extend(own, own, NID_subject_key_identifier, "hash") &&
                    X509_sign(own.get(), key.get(), EVP_sha256()) > 0;
  if (!good) return Fail(CannotCertify());
  Authority authority(key, own, life);
  TRY(authority.own_, PemOf(own, key));
  return authority;
}

Result<Credential> Authority::Issue(const std::string& common_name, const char* usage,
                                    const std::string& names) const {
  const Key key(EVP_EC_gen("P-256"), &EVP_PKEY_free);
  const Certificate certificate = key == nullptr ? nullptr : Blank(common_name, key, life_);
  const bool good =
      certificate != nullptr &&
      X509_set_issuer_name(certificate.get(), X509_get_subject_name(certificate_.get())) == 1 &&
      Extend(certificate, certificate_, NID_basic_constraints, "critical,CA:FALSE") &&
      Extend(certificate, certificate_, NID_key_usage, "critical,digitalSignature") &&
      Extend(certificate, certificate_, NID_ext_key_usage, usage) &&
      Extend(certificate, certificate_, NID_subject_key_identifier, "hash") &&
      Extend(certificate, certificate_, NID_authority_key_identifier, "keyid") &&
      (names.empty() || Extend(certificate, certificate_, NID_subject_alt_name, names)) &&
      X509_sign(certificate.get(), key_.get(), EVP_sha256()) > 0;
  if (!good) return Fail(CannotCertify());
  return PemOf(certificate, key);
}

Result<Credential> Authority::ForServer(const std::vector<std::string>& hosts) const {
  std::string names;
  for (const std::string& host : hosts) {
    const bool address = IsAddress(host);
    if (!address && !IsHostName(host)) {
      return Fail(Fault(FaultKind::kInvalidOption, host + " is neither host name nor IP address.")
                      .Field("hosts"));
    }
    names += (names.empty() ? "" : ",") + std::string(address ? "IP:" : "DNS:") + host;
  }
  // Clients go by the names alone. A common name is at most 64 characters long, hosts may be longer.
  return Issue("arapd", "serverAuth", names);
}

Result<Credential> Authority::ForClient(const std::string& owner) const {
  return Issue(owner, "clientAuth", "");
}

}  // namespace arap
