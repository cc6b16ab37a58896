// KnownSizes: how large the meshes of a session are, as far as this side knows: because it has sent
// the mesh, or has asked for it. Shapes are checked against that.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>

#include "core/base/mutex.h"

namespace arap::client::internal {

struct MeshSize {
  std::size_t vertices = 0, triangles = 0;
};

// Thread-safe. Shared by the copies of a Session and their streams.
class KnownSizes {
 public:
  void Know(const std::string& mesh_id, MeshSize size);
  void Forget(const std::string& mesh_id);
  // Which mesh a handle set is on.
  void KnowSet(const std::string& handle_set_id, const std::string& mesh_id);
  void ForgetSet(const std::string& handle_set_id);
  // Nothing for a set or mesh that was never seen.
  std::optional<MeshSize> OfSet(const std::string& handle_set_id) const;
  std::optional<MeshSize> OfMesh(const std::string& mesh_id) const;

 private:
  mutable Mutex mutex_;
  std::map<std::string, MeshSize> meshes_ ABSL_GUARDED_BY(mutex_);
  std::map<std::string, std::string> sets_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace arap::client::internal
