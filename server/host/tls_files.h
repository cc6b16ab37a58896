// TlsFiles: the certificate files as they were when they last could be used, for gRPC to watch.
#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <string>

#include "arap/base/result.h"
#include "server/host/credentials.h"

namespace arap::host {

// gRPC ends the process over an empty certificate file, and fails every handshake while key and
// certificate do not belong together. So it gets copies that were checked. They are in memory only.
// Thread-safe. Outlives the credentials that use copies().
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
  std::mutex mutex_;
  // Guarded by mutex_.
  Texts texts_;
  Texts refused_;
  std::array<int, kFiles> descriptors_{-1, -1, -1};
};

}  // namespace arap::host
