// MeshCache: equal meshes share one RegisteredMesh for as long as anybody holds it.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "core/deform/registered_mesh.h"

namespace arap::app {

// Thread-safe. Holds no memory alive: it only remembers meshes that sessions or running work hold.
class MeshCache {
 public:
  // The mesh of this content hash, or null.
  std::shared_ptr<const RegisteredMesh> Find(const std::string& hash) const;

  // Remembers `mesh`. If an equal one was remembered meanwhile, that one is returned, else `mesh`.
  std::shared_ptr<const RegisteredMesh> Share(const std::string& hash,
                                              std::shared_ptr<const RegisteredMesh> mesh);

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::weak_ptr<const RegisteredMesh>> meshes_;  // guarded by mutex_
};

}  // namespace arap::app
