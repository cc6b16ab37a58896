// Access: who may connect to a server, how, and whom it takes them for.
#pragma once

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "arap/base/result.h"
#include "server/budget/limits.h"
#include "server/host/credentials.h"
#include "server/host/tls_files.h"
#include "server/rpc/caller_of.h"
#include "server/runtime/clock.h"

namespace arap::host {

// An identity is demanded from everyone, on every address, as soon as there is a token file or a
// client certificate is required. Only GetServerInfo, health and reflection need none.
struct AccessOptions {
  TlsOptions tls;
  std::string token_file;        // see token_file.h; empty: no tokens
  bool allow_plaintext = false;  // see CheckExposure
  bool allow_anyone = false;     // likewise
  // How often the token file is looked at: what a token allows, open streams included, ends at most
  // this long after the token was revoked or has expired.
  std::chrono::milliseconds refresh = std::chrono::seconds(5);
};

// Thread-safe. Keep it until the server that uses it is gone.
class Access {
 public:
  // Faults as CheckExposure, CheckTls and Tokens::Open. `defaults` are the limits of owners whose
  // token states none.
  static Result<std::unique_ptr<Access>> Open(const AccessOptions& options,
                                              const std::vector<std::string>& listen,
                                              const app::OwnerLimits& defaults,
                                              std::shared_ptr<const runtime::Clock> clock);
  ~Access();
  Access(const Access&) = delete;
  Access& operator=(const Access&) = delete;

  const rpc::Identity& identity() const { return identity_; }
  // For builder.AddListeningPort. The rule is in credentials.h.
  std::shared_ptr<grpc::ServerCredentials> CredentialsFor(const std::string& address) const;

  // Reads tokens and certificates at once, as for SIGHUP; files that cannot be used leave things as
  // they were, and are the fault.
  Status Reload();

 private:
  explicit Access(std::shared_ptr<const runtime::Clock> clock) : clock_(std::move(clock)) {}
  void KeepFresh(const std::stop_token& stop, std::chrono::milliseconds period);
  Status RefreshCertificates(bool insist);

  const std::shared_ptr<const runtime::Clock> clock_;
  rpc::Identity identity_;
  std::unique_ptr<TlsFiles> tls_;
  std::shared_ptr<grpc::ServerCredentials> tcp_;
  std::mutex mutex_;  // only to wait with
  std::condition_variable_any waiting_;
  std::jthread refresher_;  // last, so that it ends first
};

}  // namespace arap::host
