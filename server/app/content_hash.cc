#include "server/app/content_hash.h"

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include <openssl/evp.h>

namespace arap::app {
namespace {

// Change them whenever the same mesh would get other factors.
constexpr std::string_view kPlanarTag = "arap planar mesh 1\n";
constexpr std::string_view kSurfaceTag = "arap surface 1\n";

class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new(), &EVP_MD_CTX_free) {
    good_ = context_ != nullptr && EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1;
  }

  void Bytes(const void* data, std::size_t size) {
    good_ = good_ && EVP_DigestUpdate(context_.get(), data, size) == 1;
  }
  void Number(std::uint64_t number) { Bytes(&number, sizeof number); }
  template <class T>
  void Array(const std::vector<T>& items) {
    Number(items.size());
    Bytes(items.data(), items.size() * sizeof(T));
  }

  Result<std::string> Hex() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned int size = 0;
    good_ = good_ && EVP_DigestFinal_ex(context_.get(), digest.data(), &size) == 1;
    if (!good_) return Fail(FaultKind::kInternal, "The content hash could not be computed.");
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string hex;
    for (unsigned int i = 0; i < size; ++i) {
      hex += kDigits[digest[i] >> 4u];
      hex += kDigits[digest[i] & 15u];
    }
    return hex;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
  bool good_ = false;
};

}  // namespace

Result<std::string> ContentHash(const PlanarMesh& mesh, const EnergyOptions& options) {
  Sha256 hash;
  hash.Bytes(kPlanarTag.data(), kPlanarTag.size());
  hash.Number(static_cast<std::uint64_t>(options.basis));
  hash.Number(static_cast<std::uint64_t>(options.weights));
  hash.Array(options.rigidity);
  hash.Array(mesh.vertices);
  hash.Array(mesh.triangles);
  return hash.Hex();
}

Result<std::string> ContentHash(const SurfaceMesh& mesh, const CutOptions& options) {
  // What is hashed byte by byte has no bytes between its numbers.
  static_assert(sizeof(Eigen::Vector3d) == 3 * sizeof(double));
  Sha256 hash;
  hash.Bytes(kSurfaceTag.data(), kSurfaceTag.size());
  hash.Number(options.auto_cut ? 1 : 0);
  hash.Number(options.split_non_manifold ? 1 : 0);
  hash.Number(options.tolerate_degenerate ? 1 : 0);
  hash.Array(options.seams);
  hash.Array(mesh.vertices);
  hash.Array(mesh.triangles);
  return hash.Hex();
}

}  // namespace arap::app
