// Credentials: how a listen address talks to its clients.
//
// The rule: unix sockets are plaintext, for what may connect is decided by the file system. With a
// certificate every TCP address, loopback too, speaks TLS; without one all of them are plaintext,
// and listen.h says where that is allowed.
#pragma once

#include <memory>
#include <string>

#include "arap/base/result.h"

namespace grpc {
class ServerCredentials;
}

namespace arap::host {

// Files in PEM. They are looked at again every `refresh_seconds`: new connections get what is there
// then, open ones go on. Files that cannot be used, or do not belong together, leave things as they
// were (tls_files.h).
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

}  // namespace arap::host
