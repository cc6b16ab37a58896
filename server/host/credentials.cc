#include "server/host/credentials.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <grpcpp/security/server_credentials.h>
#include <grpcpp/security/tls_certificate_provider.h>
#include <grpcpp/security/tls_credentials_options.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>
#include <spdlog/spdlog.h>
#include <sys/mman.h>
#include <unistd.h>

#include "core/base/try.h"
#include "server/host/listen.h"

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
  TRY(const File file, Open(path, field));
  Certificate certificate(PEM_read_X509(file.get(), nullptr, &NoPassphrase, nullptr), &X509_free);
  ERR_clear_error();
  if (!certificate) return Fail(Bad(path, field, "holds no certificate in PEM"));
  return certificate;
}

Result<Key> ReadKey(const std::string& path, const char* field) {
  TRY(const File file, Open(path, field));
  Key key(PEM_read_PrivateKey(file.get(), nullptr, &NoPassphrase, nullptr), &EVP_PKEY_free);
  ERR_clear_error();
  if (!key) return Fail(Bad(path, field, "holds no private key in PEM without a passphrase"));
  return key;
}

std::string PathOf(int descriptor) { return "/proc/self/fd/" + std::to_string(descriptor); }

std::string TextOf(const std::string& path) {
  std::ostringstream text;
  if (!path.empty()) text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

// A file in memory that holds `text`, or -1.
int InMemory(const std::string& text) {
  const int descriptor = memfd_create("arapd-tls", MFD_CLOEXEC);
  if (descriptor < 0) return -1;
  if (write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size())) {
    return descriptor;
  }
  close(descriptor);
  return -1;
}

std::array<std::string*, 3> PathsIn(TlsOptions& tls) {
  return {&tls.certificate, &tls.key, &tls.client_ca};
}

// Files in memory, closed unless they are taken.
struct Fresh {
  std::array<int, 3> descriptors{-1, -1, -1};
  ~Fresh() {
    for (const int descriptor : descriptors) {
      if (descriptor >= 0) close(descriptor);
    }
  }
};

void LogOutcome(const app::Tokens& tokens, const Status& reloaded) {
  if (reloaded) {
    spdlog::info("event=tokens_reloaded tokens={}", tokens.size());
  } else {
    spdlog::warn("event=tokens_kept reason=\"{}\"", reloaded.error().message);
  }
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
  TRY(const Certificate certificate, ReadCertificate(tls.certificate, "tls_cert"));
  TRY(const Key key, ReadKey(tls.key, "tls_key"));
  const bool match = X509_check_private_key(certificate.get(), key.get()) == 1;
  ERR_clear_error();
  if (!match) {
    return Fail(Bad(tls.key, "tls_key", "is not the key of the certificate " + tls.certificate));
  }
  if (tls.client_ca.empty()) return {};
  CHECK_OK(ReadCertificate(tls.client_ca, "tls_client_ca"));
  return {};
}

Result<std::shared_ptr<grpc::ServerCredentials>> TcpCredentials(const TlsOptions& tls) {
  CHECK_OK(CheckTls(tls));
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

Result<std::unique_ptr<TlsFiles>> TlsFiles::Open(const TlsOptions& tls) {
  CHECK_OK(CheckTls(tls));
  std::unique_ptr<TlsFiles> files(new TlsFiles(tls));
  if (!tls.given()) return files;
  CHECK_OK(files->Refresh(true));
  return files;
}

TlsFiles::~TlsFiles() {
  for (const int descriptor : descriptors_) {
    if (descriptor >= 0) close(descriptor);
  }
}

Result<bool> TlsFiles::Refresh(bool insist) {
  const MutexLock lock(&mutex_);
  TlsOptions files = files_;
  Texts texts;
  for (std::size_t i = 0; i < kFiles; ++i) texts[i] = TextOf(*PathsIn(files)[i]);
  if (texts == texts_ || (texts == refused_ && !insist)) return false;
  refused_ = texts;
  Fresh fresh;
  TlsOptions checked = files_;
  for (std::size_t i = 0; i < kFiles; ++i) {
    std::string& path = *PathsIn(checked)[i];
    if (path.empty()) continue;
    fresh.descriptors[i] = InMemory(texts[i]);
    if (fresh.descriptors[i] < 0) {
      return Fail(FaultKind::kInternal,
                  "No memory for the certificates: " + std::generic_category().message(errno));
    }
    path = PathOf(fresh.descriptors[i]);
  }
  // What was read is what counts; the names of the files are for the message.
  if (auto good = CheckTls(checked); !good) {
    CHECK_OK(CheckTls(files_));
    return Fail(std::move(good.error()));
  }
  for (std::size_t i = 0; i < kFiles; ++i) {
    if (descriptors_[i] < 0) {
      descriptors_[i] = std::exchange(fresh.descriptors[i], -1);
    } else if (dup3(fresh.descriptors[i], descriptors_[i], O_CLOEXEC) < 0) {
      return Fail(FaultKind::kInternal, "The certificates cannot be put in place: " +
                                            std::generic_category().message(errno));
    }
    if (descriptors_[i] >= 0) *PathsIn(copies_)[i] = PathOf(descriptors_[i]);
  }
  texts_ = std::move(texts);
  refused_ = {};
  return true;
}

Result<std::unique_ptr<Credentials>> Credentials::Open(
    const CredentialOptions& options, const std::vector<std::string>& listen,
    const OwnerLimits& defaults, std::shared_ptr<const runtime::Clock> clock) {
  const bool demanded = !options.token_file.empty() || options.tls.require_client_certificate;
  const Exposure exposure{options.tls.given(), demanded, options.allow_plaintext,
                          options.allow_anyone};
  CHECK_OK(CheckExposure(listen, exposure));
  TRY(auto tls, TlsFiles::Open(options.tls));
  TRY(auto tcp, TcpCredentials(tls->copies()));

  std::unique_ptr<Credentials> credentials(new Credentials(std::move(clock)));
  credentials->tls_ = std::move(tls);
  credentials->tcp_ = std::move(tcp);
  credentials->identity_.demanded = demanded;
  credentials->identity_.limits = defaults;
  if (!options.token_file.empty()) {
    TRY(credentials->identity_.tokens,
        app::Tokens::Open(options.token_file, defaults, *credentials->clock_));
  }
  if (!credentials->identity_.tokens && !options.tls.given()) return credentials;
  const auto period = std::min<std::chrono::milliseconds>(
      options.refresh, std::chrono::seconds(options.tls.refresh_seconds));
  credentials->refresher_ =
      std::make_unique<runtime::Ticker>(period, [self = credentials.get()] { self->Refresh(); });
  return credentials;
}

Credentials::~Credentials() = default;

std::shared_ptr<grpc::ServerCredentials> Credentials::CredentialsFor(
    const std::string& address) const {
  return UnixPath(address).empty() ? tcp_ : grpc::InsecureServerCredentials();
}

Status Credentials::Reload() {
  Status certificates = RefreshCertificates(true);
  if (!identity_.tokens) return certificates;
  const Status reloaded = identity_.tokens->Reload();
  LogOutcome(*identity_.tokens, reloaded);
  return reloaded ? certificates : reloaded;
}

Status Credentials::RefreshCertificates(bool insist) {
  const auto refreshed = tls_->Refresh(insist);
  if (refreshed && *refreshed) spdlog::info("event=certificates_reloaded");
  if (refreshed) return {};
  spdlog::warn("event=certificates_kept reason=\"{}\"", refreshed.error().message);
  return Fail(refreshed.error());
}

void Credentials::Refresh() {
  static_cast<void>(RefreshCertificates(false));
  if (!identity_.tokens) return;
  const auto refreshed = identity_.tokens->Refresh();
  if (!refreshed) LogOutcome(*identity_.tokens, Fail(refreshed.error()));
  if (refreshed && *refreshed) LogOutcome(*identity_.tokens, {});
}

}  // namespace arap::host
