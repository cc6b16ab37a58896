#include "tests/system/wire/authority.h"

#include <atomic>
#include <cstdlib>

#include <gtest/gtest.h>
#include <openssl/bio.h>
#include <openssl/ec.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509v3.h>

namespace arap::wire {
namespace {

using Key = std::shared_ptr<EVP_PKEY>;
using Certificate = std::shared_ptr<X509>;

void Require(bool done) {
  if (done) return;
  ADD_FAILURE() << "OpenSSL refused to make a certificate";
  std::abort();
}

Key NewKey() {
  Key key(EVP_EC_gen("P-256"), &EVP_PKEY_free);
  Require(key != nullptr);
  return key;
}

template <class Write>
std::string Pem(Write write) {
  const std::unique_ptr<BIO, int (*)(BIO*)> memory(BIO_new(BIO_s_mem()), &BIO_free);
  Require(write(memory.get()) == 1);
  char* data = nullptr;
  const long size = BIO_get_mem_data(memory.get(), &data);
  return {data, static_cast<std::size_t>(size)};
}

std::string Pem(const Certificate& certificate) {
  return Pem([&](BIO* memory) { return PEM_write_bio_X509(memory, certificate.get()); });
}

void Extend(X509& certificate, int kind, const char* value) {
  const std::unique_ptr<X509_EXTENSION, void (*)(X509_EXTENSION*)> extension(
      X509V3_EXT_conf_nid(nullptr, nullptr, kind, value), &X509_EXTENSION_free);
  Require(extension != nullptr && X509_add_ext(&certificate, extension.get(), -1) == 1);
}

// Without issuer and signature.
Certificate Blank(const std::string& common_name, EVP_PKEY* key) {
  static std::atomic<long> serial{1};
  constexpr long kHour = 3'600;
  Certificate certificate(X509_new(), &X509_free);
  X509* const raw = certificate.get();
  Require(X509_set_version(raw, 2) == 1);
  Require(ASN1_INTEGER_set(X509_get_serialNumber(raw), serial++) == 1);
  Require(X509_gmtime_adj(X509_getm_notBefore(raw), -kHour) != nullptr);
  Require(X509_gmtime_adj(X509_getm_notAfter(raw), 24 * kHour) != nullptr);
  Require(X509_set_pubkey(raw, key) == 1);
  Require(X509_NAME_add_entry_by_txt(X509_get_subject_name(raw), "CN", MBSTRING_UTF8,
                                     reinterpret_cast<const unsigned char*>(common_name.data()),
                                     static_cast<int>(common_name.size()), -1, 0) == 1);
  return certificate;
}

}  // namespace

Authority::Authority(const std::string& name) : key_(NewKey()), own_(Blank(name, key_.get())) {
  Require(X509_set_issuer_name(own_.get(), X509_get_subject_name(own_.get())) == 1);
  Extend(*own_, NID_basic_constraints, "critical,CA:TRUE");
  Extend(*own_, NID_key_usage, "critical,keyCertSign");
  Require(X509_sign(own_.get(), key_.get(), EVP_sha256()) > 0);
  certificate_ = Pem(own_);
}

Credential Authority::Issue(const std::string& common_name) const {
  const Key key = NewKey();
  const Certificate certificate = Blank(common_name, key.get());
  Require(X509_set_issuer_name(certificate.get(), X509_get_subject_name(own_.get())) == 1);
  Extend(*certificate, NID_subject_alt_name, "DNS:localhost,IP:127.0.0.1");
  Require(X509_sign(certificate.get(), key_.get(), EVP_sha256()) > 0);
  return {Pem(certificate), Pem([&](BIO* memory) {
            return PEM_write_bio_PrivateKey(memory, key.get(), nullptr, nullptr, 0, nullptr,
                                            nullptr);
          })};
}

}  // namespace arap::wire
