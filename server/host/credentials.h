// Credentials: what a server shows of itself and asks of others: who may connect to it, how, and
// whom it takes them for.
//
// The rule: unix sockets are plaintext, for what may connect is decided by the file system. With a
// certificate every TCP address, loopback too, speaks TLS; without one all of them are plaintext,
// and listen.h says where that is allowed.
#pragma once

#include <array>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/limits.h"
#include "core/base/mutex.h"
#include "server/rpc/caller_of.h"
#include "server/runtime/clock.h"
#include "server/runtime/ticker.h"

namespace grpc {
class ServerCredentials;
}

namespace arap::host {

// Files in PEM. They are looked at again every `refresh_seconds`: new connections get what is there
// then, open ones go on. Files that cannot be used, or do not belong together, leave things as they
// were.
struct TlsOptions {
  std::string certificate;  // the server's, then those that lead to its authority
  std::string key;          // its private key, without a passphrase
  // The authorities whose client certificates are believed; empty: none is asked for.
  std::string client_ca;
  // Refuse connections without a client certificate. A certificate that `client_ca` does not vouch
  // for is refused in any case.
  bool require_client_certificate = false;
  unsigned refresh_seconds = 5;

  bool given() const { return !certificate.empty() || !key.empty() || !client_ca.empty(); }
};

// kInvalidOption with the file and the field ("tls_cert", "tls_key", "tls_client_ca"): options that
// do not go together, a file that is missing, unreadable or no PEM, a key that is not the
// certificate's.
Status CheckTls(const TlsOptions& tls);

// What the TCP addresses use. The files have to be usable whenever gRPC looks, which is every
// second. Faults as CheckTls.
Result<std::shared_ptr<grpc::ServerCredentials>> TcpCredentials(const TlsOptions& tls);

// The certificate files as they were when they last could be used, for gRPC to watch: it ends the
// process over an empty certificate file, and fails every handshake while key and certificate do
// not belong together. So it gets copies that were checked. They are in memory only. Thread-safe.
// Outlives the credentials that use copies().
class TlsFiles {
 public:
  // Faults as CheckTls. `tls` names files.
  static Result<std::unique_ptr<TlsFiles>> Open(const TlsOptions& tls);
  ~TlsFiles();
  TlsFiles(const TlsFiles&) = delete;
  TlsFiles& operator=(const TlsFiles&) = delete;

  // The same options with the paths of the copies.
  const TlsOptions& copies() const { return copies_; }

  // Reads the files again: whether there was anything new. A fault, as CheckTls, leaves the copies
  // as they were; it comes once for the same files, or with `insist` every time.
  Result<bool> Refresh(bool insist);

 private:
  static constexpr std::size_t kFiles = 3;
  using Texts = std::array<std::string, kFiles>;  // certificate, key, authorities

  explicit TlsFiles(const TlsOptions& tls) : files_(tls), copies_(tls) {}

  const TlsOptions files_;
  TlsOptions copies_;
  Mutex mutex_;
  Texts texts_ ABSL_GUARDED_BY(mutex_);
  Texts refused_ ABSL_GUARDED_BY(mutex_);
  std::array<int, kFiles> descriptors_{-1, -1, -1};  // only Refresh changes them
};

// An identity is demanded from everyone, on every address, as soon as there is a token file or a
// client certificate is required. Only GetServerInfo, health and reflection need none.
struct CredentialOptions {
  TlsOptions tls;
  std::string token_file;        // see core/token/token.h; empty: no tokens
  bool allow_plaintext = false;  // see CheckExposure in listen.h
  bool allow_anyone = false;     // likewise
  // How often the token file is looked at: what a token allows, open streams included, ends at most
  // this long after the token was revoked or has expired.
  std::chrono::milliseconds refresh = std::chrono::seconds(5);
};

// Thread-safe. Keep it until the server that uses it is gone.
class Credentials {
 public:
  // Faults as CheckExposure, CheckTls and Tokens::Open. `defaults` are the limits of owners whose
  // token states none.
  static Result<std::unique_ptr<Credentials>> Open(const CredentialOptions& options,
                                                   const std::vector<std::string>& listen,
                                                   const OwnerLimits& defaults,
                                                   std::shared_ptr<const runtime::Clock> clock);
  ~Credentials();
  Credentials(const Credentials&) = delete;
  Credentials& operator=(const Credentials&) = delete;

  const rpc::Identity& identity() const { return identity_; }
  // For builder.AddListeningPort.
  std::shared_ptr<grpc::ServerCredentials> CredentialsFor(const std::string& address) const;

  // Reads tokens and certificates at once, as for SIGHUP; files that cannot be used leave things as
  // they were, and are the fault.
  Status Reload();

 private:
  explicit Credentials(std::shared_ptr<const runtime::Clock> clock) : clock_(std::move(clock)) {}
  // Takes what has changed since the last look.
  void Refresh();
  Status RefreshCertificates(bool insist);

  const std::shared_ptr<const runtime::Clock> clock_;
  rpc::Identity identity_;
  std::unique_ptr<TlsFiles> tls_;
  std::shared_ptr<grpc::ServerCredentials> tcp_;
  std::unique_ptr<runtime::Ticker> refresher_;  // last, so that it ends first
};

}  // namespace arap::host
