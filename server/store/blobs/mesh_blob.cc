#include "server/store/blobs/mesh_blob.h"

#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

namespace arap::store {
namespace {

// To be changed whenever the same mesh would get other factors.
constexpr std::string_view kTag = "arap planar mesh 1\n";

void Append(std::string& bytes, const void* data, std::size_t size) {
  bytes.append(static_cast<const char*>(data), size);
}
void AppendNumber(std::string& bytes, std::uint64_t number) {
  Append(bytes, &number, sizeof number);
}
template <class T>
void AppendArray(std::string& bytes, const std::vector<T>& items) {
  AppendNumber(bytes, items.size());
  Append(bytes, items.data(), items.size() * sizeof(T));
}

// Takes bytes from the front. After the first read that fails all others fail too.
class Reader {
 public:
  explicit Reader(std::string_view bytes) : left_(bytes) {}

  bool Tag(std::string_view tag) {
    if (!left_.starts_with(tag)) return false;
    left_.remove_prefix(tag.size());
    return true;
  }
  bool Number(std::uint64_t& number) {
    if (left_.size() < sizeof number) return false;
    std::memcpy(&number, left_.data(), sizeof number);
    left_.remove_prefix(sizeof number);
    return true;
  }
  template <class T>
  bool Array(std::vector<T>& items) {
    std::uint64_t count = 0;
    if (!Number(count) || count > left_.size() / sizeof(T)) return false;
    items.resize(static_cast<std::size_t>(count));
    const std::size_t size = items.size() * sizeof(T);
    if (size > 0) std::memcpy(static_cast<void*>(items.data()), left_.data(), size);
    left_.remove_prefix(size);
    return true;
  }
  bool AtEnd() const { return left_.empty(); }

 private:
  std::string_view left_;
};

}  // namespace

std::string EncodeMesh(const PlanarMesh& mesh, const EnergyOptions& options) {
  std::string bytes(kTag);
  bytes.reserve(kTag.size() + 5 * sizeof(std::uint64_t) + options.rigidity.size() * sizeof(double) +
                mesh.vertices.size() * sizeof(Complex) + mesh.triangles.size() * sizeof(Triangle));
  AppendNumber(bytes, static_cast<std::uint64_t>(options.basis));
  AppendNumber(bytes, static_cast<std::uint64_t>(options.weights));
  AppendArray(bytes, options.rigidity);
  AppendArray(bytes, mesh.vertices);
  AppendArray(bytes, mesh.triangles);
  return bytes;
}

Result<MeshBlob> DecodeMesh(std::string_view bytes) {
  Reader reader(bytes);
  MeshBlob blob;
  std::uint64_t basis = 0, weights = 0;
  const bool good = reader.Tag(kTag) && reader.Number(basis) && reader.Number(weights) &&
                    basis <= static_cast<std::uint64_t>(Basis::kVertex) &&
                    weights <= static_cast<std::uint64_t>(Weights::kCotangent) &&
                    reader.Array(blob.options.rigidity) && reader.Array(blob.mesh.vertices) &&
                    reader.Array(blob.mesh.triangles) && reader.AtEnd();
  if (!good) return Fail(FaultKind::kDataLoss, "A stored mesh is not in the form of this version.");
  blob.options.basis = static_cast<Basis>(basis);
  blob.options.weights = static_cast<Weights>(weights);
  return blob;
}

}  // namespace arap::store
