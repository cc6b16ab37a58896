// BlobStore: immutable bytes by their SHA-256.
#pragma once

#include <chrono>
#include <cstddef>
#include <set>
#include <string>
#include <string_view>

#include "arap/base/result.h"

namespace arap::store {

struct SweepReport {
  std::size_t removed = 0;
  std::size_t removed_bytes = 0;
  std::size_t kept = 0;
  std::size_t kept_bytes = 0;
};

// Thread-safe; calls may block on disk. Faults as in SpecStore: kStoreUnavailable, kDataLoss.
class BlobStore {
 public:
  virtual ~BlobStore() = default;

  // Durable when it returns. `hash` is the SHA-256 of `bytes`. A blob that is there already is as
  // young afterwards as a new one.
  virtual Status Put(const std::string& hash, std::string_view bytes) = 0;
  // kDataLoss when it is missing or no longer what its name says; details "blob" and "why".
  virtual Result<std::string> Get(const std::string& hash) = 0;
  // Removes blobs that are not in `referenced` and older than `age`: a younger one may belong to a
  // record that is about to be written. Also what interrupted writes left behind.
  virtual Result<SweepReport> Sweep(const std::set<std::string>& referenced,
                                    std::chrono::seconds age) = 0;
};

}  // namespace arap::store
