// A certificate authority for tests.
#pragma once

#include <memory>
#include <string>

#include <openssl/types.h>

namespace arap::wire {

// PEM texts.
struct Credential {
  std::string certificate;
  std::string key;
};

class Authority {
 public:
  explicit Authority(const std::string& name);
  // Its own certificate, in PEM.
  const std::string& certificate() const { return certificate_; }
  // For servers and clients; as a server's it is that of localhost and 127.0.0.1.
  Credential Issue(const std::string& common_name) const;

 private:
  std::shared_ptr<EVP_PKEY> key_;
  std::shared_ptr<X509> own_;
  std::string certificate_;
};

}  // namespace arap::wire
