// Authority: certificates for development: who vouches, a server, its clients.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <openssl/types.h>

#include "arap/base/result.h"

namespace arap {

// A certificate and its private key, as PEM texts.
struct Credential {
  std::string certificate;
  std::string key;
};

// A host name as certificates have it: labels of letters, digits and hyphens with dots between
// them, the first of which may be a *; or an IPv4 or IPv6 address.
bool IsHostName(const std::string& text);
bool IsAddress(const std::string& text);

// Keys of the curve P-256. Certificates hold from an hour before they are made, because clocks
// differ. Everything answers kInternal when OpenSSL fails.
class Authority {
 public:
  // A new one of that name. What it issues holds as long as itself.
  static Result<Authority> Make(const std::string& name, std::chrono::days life);

  const Credential& own() const { return own_; }
  // By which a server answers to `hosts`; not empty. kInvalidOption with the field "hosts" for one
  // that is neither host name nor address.
  Result<Credential> ForServer(const std::vector<std::string>& hosts) const;
  // By which a client is `owner`: the common name.
  Result<Credential> ForClient(const std::string& owner) const;

 private:
  Authority(std::shared_ptr<EVP_PKEY> key, std::shared_ptr<X509> certificate,
            std::chrono::days life)
      : key_(std::move(key)), certificate_(std::move(certificate)), life_(life) {}

  // `usage` and `names` are extensions in OpenSSL's words.
  Result<Credential> Issue(const std::string& common_name, const char* usage,
                           const std::string& names) const;

  std::shared_ptr<EVP_PKEY> key_;
  std::shared_ptr<X509> certificate_;
  std::chrono::days life_;
  Credential own_;
};

}  // namespace arap
