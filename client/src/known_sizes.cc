#include "client/src/known_sizes.h"

namespace arap::client::internal {

void KnownSizes::Know(const std::string& mesh_id, MeshSize size) {
  const MutexLock lock(&mutex_);
  meshes_[mesh_id] = size;
}

void KnownSizes::Forget(const std::string& mesh_id) {
  const MutexLock lock(&mutex_);
  meshes_.erase(mesh_id);
  std::erase_if(sets_, [&](const auto& set) { return set.second == mesh_id; });
}

void KnownSizes::KnowSet(const std::string& handle_set_id, const std::string& mesh_id) {
  const MutexLock lock(&mutex_);
  sets_[handle_set_id] = mesh_id;
}

void KnownSizes::ForgetSet(const std::string& handle_set_id) {
  const MutexLock lock(&mutex_);
  sets_.erase(handle_set_id);
}

std::optional<MeshSize> KnownSizes::OfSet(const std::string& handle_set_id) const {
  const MutexLock lock(&mutex_);
  const auto set = sets_.find(handle_set_id);
  if (set == sets_.end()) return std::nullopt;
  const auto mesh = meshes_.find(set->second);
  return mesh == meshes_.end() ? std::nullopt : std::optional(mesh->second);
}

std::optional<MeshSize> KnownSizes::OfMesh(const std::string& mesh_id) const {
  const MutexLock lock(&mutex_);
  const auto mesh = meshes_.find(mesh_id);
  return mesh == meshes_.end() ? std::nullopt : std::optional(mesh->second);
}

}  // namespace arap::client::internal
