#include "server/flattening/flatten_cache.h"

#include <utility>

namespace arap::app {
namespace {

// What is under a key: the content has to fit too.
struct Kept {
  std::string content_hash;
  std::shared_ptr<const PreparedSurface> surface;
};

DerivedKey KeyOf(const std::string& owner, const std::string& key) {
  return {owner, DerivedKind::kSurface, key};
}

}  // namespace

std::shared_ptr<const PreparedSurface> FlattenCache::Find(const std::string& owner,
                                                          const std::string& key,
                                                          const std::string& content_hash) {
  const auto kept = derived_.Find<Kept>(KeyOf(owner, key));
  return kept && kept->content_hash == content_hash ? kept->surface : nullptr;
}

void FlattenCache::Keep(const std::string& owner, const std::string& key,
                        const std::string& content_hash,
                        std::shared_ptr<const PreparedSurface> surface) {
  const std::size_t bytes = surface->bytes();
  auto kept = std::make_shared<const Kept>(Kept{content_hash, std::move(surface)});
  derived_.Keep<Kept>(KeyOf(owner, key), std::move(kept), bytes, true);
}

}  // namespace arap::app
