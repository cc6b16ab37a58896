#include "server/sessions/content_hash.h"

#include <cstdint>
#include <string_view>
#include <vector>

#include "core/token/sha256.h"

namespace arap::app {
namespace {

// Change it whenever the same surface would get other factors.
constexpr std::string_view kSurfaceTag = "arap surface 1\n";

void Number(Sha256& hash, std::uint64_t number) { hash.Bytes(&number, sizeof number); }

template <class T>
void Array(Sha256& hash, const std::vector<T>& items) {
  Number(hash, items.size());
  hash.Bytes(items.data(), items.size() * sizeof(T));
}

}  // namespace

Result<std::string> ContentHash(const SurfaceMesh& mesh, const CutOptions& options) {
  // What is hashed byte by byte has no bytes between its numbers.
  static_assert(sizeof(Point3) == 3 * sizeof(double));
  Sha256 hash;
  hash.Bytes(kSurfaceTag.data(), kSurfaceTag.size());
  Number(hash, options.auto_cut ? 1 : 0);
  Number(hash, options.split_non_manifold ? 1 : 0);
  Number(hash, options.tolerate_degenerate ? 1 : 0);
  Array(hash, options.seams);
  Array(hash, mesh.vertices);
  Array(hash, mesh.triangles);
  return hash.Hex();
}

}  // namespace arap::app
