// FlattenCache: surfaces that callers named, prepared for flattening, so that asking again with
// other pins or weights does not begin from nothing. A view on the derived data.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "arap/core/flattener.h"
#include "server/budget/derived_cache.h"

namespace arap::app {

// Thread-safe. Keeps at most as many surfaces, of as many bytes together, as the cap of the derived
// data says; the ones that were not asked for longest go first.
class FlattenCache {
 public:
  explicit FlattenCache(DerivedCache& derived) : derived_(derived) {}

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
  DerivedCache& derived_;
};

}  // namespace arap::app
