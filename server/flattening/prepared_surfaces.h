// PreparedSurfaces: flattening, with the memory of what was flattened before. Surfaces that callers
// named stay prepared, so that asking again with other pins or weights does not begin from nothing.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/core/flattener.h"
#include "arap/model/flatten.h"
#include "arap/model/mesh.h"
#include "server/access/caller.h"
#include "server/budget/derived_cache.h"
#include "server/runtime/metrics.h"

namespace arap::app {

struct FlatAnswer {
  Flattening flat;
  bool cached = false;  // the prepared surface was there already
};

// Thread-safe. Keeps at most as many surfaces, of as many bytes together, as the cap of the derived
// data says; the ones that were not asked for longest go first.
class PreparedSurfaces {
 public:
  // The cache and the metrics outlive it. `limits` bound every surface.
  PreparedSurfaces(DerivedCache& derived, runtime::Metrics& metrics, const MeshLimits& limits)
      : derived_(derived), metrics_(metrics), limits_(limits) {}

  // Flattens `mesh` in memory that it reserves for the caller's owner. With a `surface_key`, the
  // prepared surface of this owner is looked up and kept afterwards, also when the flattening
  // itself failed; the content of mesh and cuts must be the same, so that a key that is used twice
  // costs time only. Takes as long as the flattening: for the job lane. Faults: those of
  // arap::Flatten, kInvalidName for the key, kLimitExceeded when the memory is not to be had.
  Result<FlatAnswer> Flatten(const Caller& caller, const std::string& surface_key, SurfaceMesh mesh,
                             const FlattenOptions& options, const CancelToken& cancel,
                             const FlattenProgress& progress = {});

  // What `owner` keeps under `key`, or null: nothing, or a surface of other content.
  std::shared_ptr<const PreparedSurface> Find(const std::string& owner, const std::string& key,
                                              const std::string& content_hash);
  // Keeps `surface` instead of whatever `key` named. A surface grows when it is flattened: keeping
  // it again afterwards counts its bytes anew. One that is larger than the cap is not kept.
  void Keep(const std::string& owner, const std::string& key, const std::string& content_hash,
            std::shared_ptr<const PreparedSurface> surface);

  std::size_t entries() const { return derived_.entries(DerivedKind::kSurface); }
  std::size_t bytes() const { return derived_.bytes(DerivedKind::kSurface); }

 private:
  Result<FlatAnswer> FlattenNamed(const std::string& owner, const std::string& key,
                                  SurfaceMesh mesh, const FlattenOptions& options,
                                  const CancelToken& cancel, const FlattenProgress& progress);

  DerivedCache& derived_;
  runtime::Metrics& metrics_;
  const MeshLimits limits_;
};

// Equal surfaces with equal cuts share what was prepared for them: SHA-256 over a version tag, the
// surface as it was sent and how it is cut, 64 hexadecimal digits. Equal arguments give equal
// hashes on every machine of one byte order. kInternal if the digest cannot be made.
Result<std::string> ContentHash(const SurfaceMesh& mesh, const CutOptions& options);

}  // namespace arap::app
