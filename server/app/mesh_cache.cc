#include "server/app/mesh_cache.h"

namespace arap::app {

std::shared_ptr<const RegisteredMesh> MeshCache::Find(const std::string& hash) const {
  const std::lock_guard lock(mutex_);
  const auto found = meshes_.find(hash);
  return found == meshes_.end() ? nullptr : found->second.lock();
}

std::shared_ptr<const RegisteredMesh> MeshCache::Share(const std::string& hash,
                                                       std::shared_ptr<const RegisteredMesh> mesh) {
  const std::lock_guard lock(mutex_);
  std::erase_if(meshes_, [](const auto& entry) { return entry.second.expired(); });
  auto& entry = meshes_[hash];
  if (auto other = entry.lock()) return other;
  entry = mesh;
  return mesh;
}

}  // namespace arap::app
