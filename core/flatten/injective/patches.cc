#include "core/flatten/injective/patches.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "core/base/try.h"
#include "core/flatten/distortion.h"
#include "core/flatten/injective/newton_descent.h"

namespace arap {
namespace {

constexpr std::size_t kLargestPart = 4;  // of the surface: a quarter
constexpr int kPatchPatience = 25;       // untangling steps without fewer flips
// What has just been untangled is nearly collapsed; a few steps spare the whole layout many.
constexpr int kSettling = 10;
constexpr double kSettled = 1e-2;

// The triangles that have a corner among the free vertices.
struct Patch {
  SurfaceMesh mesh;
  std::vector<bool> left_out;            // of its triangles
  std::vector<std::uint32_t> vertex_of;  // of its vertices, in the whole
  std::vector<LayoutPin> pins;           // its own, and the vertices that are held
};

class Patches {
 public:
  Patches(const SurfaceMesh& mesh, std::span<const LayoutPin> pins,
          const std::vector<bool>& left_out)
      : mesh_(mesh), left_out_(left_out), pin_of_(mesh.vertices.size()) {
    for (const LayoutPin& pin : pins) pin_of_[pin.vertex] = &pin;
  }

  // The corners of `triangles`, and whatever is fewer than `rings` edges from one.
  std::vector<bool> Free(std::span<const std::uint32_t> triangles, int rings) const {
    std::vector<bool> free(mesh_.vertices.size(), false);
    for (const std::uint32_t t : triangles) {
      for (const std::uint32_t v : mesh_.triangles[t]) free[v] = true;
    }
    for (int ring = 1; ring < rings; ++ring) {
      std::vector<bool> wider = free;
      for (const Triangle& t : mesh_.triangles) {
        if (!Touches(t, free)) continue;
        for (const std::uint32_t v : t) wider[v] = true;
      }
      free = std::move(wider);
    }
    return free;
  }

  Patch Around(const std::vector<bool>& free, std::span<const Complex> uv) const {
    constexpr auto kNone = std::numeric_limits<std::uint32_t>::max();
    Patch patch;
    std::vector<std::uint32_t> own(mesh_.vertices.size(), kNone);
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      Triangle triangle = mesh_.triangles[t];
      if (!Touches(triangle, free)) continue;
      for (std::uint32_t& v : triangle) {
        if (own[v] == kNone) own[v] = Take(v, free[v], uv, patch);
        v = own[v];
      }
      patch.mesh.triangles.push_back(triangle);
      patch.left_out.push_back(!left_out_.empty() && left_out_[t]);
    }
    return patch;
  }

 private:
  static bool Touches(const Triangle& t, const std::vector<bool>& free) {
    return free[t[0]] || free[t[1]] || free[t[2]];
  }

  std::uint32_t Take(std::uint32_t v, bool free, std::span<const Complex> uv, Patch& patch) const {
    const auto own = static_cast<std::uint32_t>(patch.vertex_of.size());
    patch.vertex_of.push_back(v);
    patch.mesh.vertices.push_back(mesh_.vertices[v]);
    if (!free) {
      patch.pins.push_back({own, uv[v], std::numeric_limits<double>::infinity()});
    } else if (pin_of_[v] != nullptr) {
      patch.pins.push_back({own, pin_of_[v]->uv, pin_of_[v]->weight});
    }
    return own;
  }

  const SurfaceMesh& mesh_;
  const std::vector<bool>& left_out_;
  std::vector<const LayoutPin*> pin_of_;  // #V, or null
};

}  // namespace

Result<bool> MendPatches(const SurfaceMesh& mesh, std::span<const LayoutPin> pins,
                         const std::vector<bool>& left_out, const CancelToken& cancel,
                         std::vector<Complex>& uv, int& iterations) {
  const std::vector<std::uint32_t> flipped = NotUpright(mesh.triangles, uv, left_out);
  if (flipped.empty() || flipped.size() * kLargestPart > mesh.triangles.size()) return false;
  const Patches patches(mesh, pins, left_out);
  for (const int rings : {2, 4, 8}) {
    const Patch patch = patches.Around(patches.Free(flipped, rings), uv);
    if (patch.mesh.triangles.size() * kLargestPart > mesh.triangles.size()) break;
    std::vector<Complex> part;
    part.reserve(patch.vertex_of.size());
    for (const std::uint32_t v : patch.vertex_of) part.push_back(uv[v]);
    Newton newton = Newton::Make(patch.mesh, patch.pins, patch.left_out);
    const DescentProblem problem{newton, patch.mesh.triangles, patch.left_out, cancel};
    CHECK_OK(Untangle(problem, kPatchPatience, part, iterations));
    if (!NotUpright(patch.mesh.triangles, part, patch.left_out).empty()) continue;
    CHECK_OK(Descend(problem, kSettled, kSettling, part, iterations));
    for (std::size_t k = 0; k < part.size(); ++k) uv[patch.vertex_of[k]] = part[k];
    return true;
  }
  return false;
}

}  // namespace arap
