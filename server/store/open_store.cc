#include "server/store/open_store.h"

#include "server/store/memory_store.h"
namespace arap::store {
Result<Stores> OpenStores(const StoreOptions&) {
  return Stores{std::make_unique<MemorySpecStore>(), std::make_unique<MemoryBlobStore>()};
}
}  // namespace arap::store
