// How a Client connects and who it says it is.
#pragma once

#include <string>

namespace arap::client {

// Files are in PEM and read once, when connecting. Nothing of this is ever in a message or a log.
struct ConnectOptions {
  // Bearer token, sent with every call; empty: none. `arapctl token add` makes them.
  std::string token;
  // Without TLS a token is sent to this machine only (loopback, unix sockets), unless this allows
  // everybody on the way to read it.
  bool token_in_plaintext = false;

  bool tls = false;               // implied by each of the files
  std::string root_certificates;  // who vouches for the server; empty: the system's authorities
  std::string certificate;        // the client's own, with its key, for servers that want one
  std::string key;
  std::string server_name;  // what the server's certificate says, unless that is in the address

  bool wants_tls() const {
    return tls || !root_certificates.empty() || !certificate.empty() || !key.empty();
  }
};

}  // namespace arap::client
