// Opening the stores.
#pragma once

#include <memory>
#include <string>

#include "server/store/blob_store.h"
#include "server/store/spec_store.h"

namespace arap::store {

struct StoreOptions {
  std::string store = "memory";
  std::string blob_dir;
};

struct Stores {
  std::unique_ptr<SpecStore> specs;
  std::unique_ptr<BlobStore> blobs;
};

Result<Stores> OpenStores(const StoreOptions& options);

}  // namespace arap::store
