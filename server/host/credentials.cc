#include "server/host/credentials.h"

#include <cerrno>
#include <cstdio>
#include <system_error>

#include <fmt/format.h>
#include <grpcpp/security/server_credentials.h>
#include <grpcpp/security/tls_certificate_provider.h>
#include <grpcpp/security/tls_credentials_options.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

namespace arap::host {
namespace {

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;
using Certificate = std::unique_ptr<X509, void (*)(X509*)>;
using Key = std::unique_ptr<EVP_PKEY, void (*)(EVP_PKEY*)>;

Fault Bad(const std::string& path, const char* field, const std::string& why) {
  Fault fault =
      Fault(FaultKind::kInvalidOption, path.empty() ? fmt::format("{} {}.", field, why)
                                                    : fmt::format("{} {} {}.", field, path, why))
          .Field(field);
  return path.empty() ? fault : fault.Detail("file", path);
}

// A key with a passphrase is refused instead of asking the terminal for it.
int NoPassphrase(char* /*buffer*/, int /*size*/, int /*writing*/, void* /*data*/) { return -1; }

Result<File> Open(const std::string& path, const char* field) {
  File file(std::fopen(path.c_str(), "re"), [](std::FILE* open) { return std::fclose(open); });
  if (!file) {
    return Fail(Bad(path, field, "cannot be read: " + std::generic_category().message(errno)));
  }
  return file;
}

Result<Certificate> ReadCertificate(const std::string& path, const char* field) {
  auto file = Open(path, field);
  if (!file) return Fail(std::move(file.error()));
  Certificate certificate(PEM_read_X509(file->get(), nullptr, &NoPassphrase, nullptr), &X509_free);
  ERR_clear_error();
  if (!certificate) return Fail(Bad(path, field, "holds no certificate in PEM"));
  return certificate;
}

Result<Key> ReadKey(const std::string& path, const char* field) {
  auto file = Open(path, field);
  if (!file) return Fail(std::move(file.error()));
  Key key(PEM_read_PrivateKey(file->get(), nullptr, &NoPassphrase, nullptr), &EVP_PKEY_free);
  ERR_clear_error();
  if (!key) return Fail(Bad(path, field, "holds no private key in PEM without a passphrase"));
  return key;
}

}  // namespace

Status CheckTls(const TlsOptions& tls) {
  if (tls.certificate.empty() != tls.key.empty() || (tls.certificate.empty() && tls.given())) {
    const char* const missing = tls.certificate.empty() ? "tls_cert" : "tls_key";
    return Fail(Bad("", missing, "is missing: TLS needs a certificate and its key"));
  }
  if (tls.require_client_certificate && tls.client_ca.empty()) {
    return Fail(Bad("", "tls_client_ca",
                    "is missing: client certificates are demanded, but nobody vouches for them"));
  }
  if (!tls.given()) return {};
  const auto certificate = ReadCertificate(tls.certificate, "tls_cert");
  if (!certificate) return Fail(certificate.error());
  const auto key = ReadKey(tls.key, "tls_key");
  if (!key) return Fail(key.error());
  const bool match = X509_check_private_key(certificate->get(), key->get()) == 1;
  ERR_clear_error();
  if (!match) {
    return Fail(Bad(tls.key, "tls_key", "is not the key of the certificate " + tls.certificate));
  }
  if (tls.client_ca.empty()) return {};
  if (auto read = ReadCertificate(tls.client_ca, "tls_client_ca"); !read) {
    return Fail(std::move(read.error()));
  }
  return {};
}

Result<std::shared_ptr<grpc::ServerCredentials>> TcpCredentials(const TlsOptions& tls) {
  if (auto good = CheckTls(tls); !good) return Fail(std::move(good.error()));
  if (!tls.given()) return grpc::InsecureServerCredentials();
  using grpc::experimental::FileWatcherCertificateProvider;
  grpc::experimental::TlsServerCredentialsOptions options(
      std::make_shared<FileWatcherCertificateProvider>(tls.key, tls.certificate, tls.client_ca,
                                                       /*refresh_interval_sec=*/1));
  options.watch_identity_key_cert_pairs();
  // The default verifier looks for host names, which client certificates do not have.
  options.set_check_call_host(false);
  if (!tls.client_ca.empty()) {
    options.watch_root_certs();
    options.set_cert_request_type(tls.require_client_certificate
                                      ? GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY
                                      : GRPC_SSL_REQUEST_CLIENT_CERTIFICATE_AND_VERIFY);
  }
  return grpc::experimental::TlsServerCredentials(options);
}

}  // namespace arap::host
