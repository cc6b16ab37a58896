// Credentials: what a server shows of itself and asks of others: who may connect to a server, how,
// and whom it takes them for.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/limits.h"
#include "server/host/tls.h"
#include "server/rpc/caller_of.h"
#include "server/runtime/clock.h"
#include "server/runtime/ticker.h"

namespace arap::host {

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
  // For builder.AddListeningPort. The rule is in tls.h.
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
