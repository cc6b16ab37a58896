#include "core/deform/registered_parts.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>

namespace arap {
namespace {

std::array<Complex, 3> Rests(const RegisteredMeshParts& mesh, const Triangle& t) {
  return {mesh.rest[t[0]], mesh.rest[t[1]], mesh.rest[t[2]]};
}

// The same weights for the corners in another order.
std::array<double, 3> Reordered(const Triangle& from, const std::array<double, 3>& weights,
                                const Triangle& to) {
  std::array<double, 3> out{};
  for (std::size_t k = 0; k < 3; ++k) {
    out[k] = weights[static_cast<std::size_t>(std::find(from.begin(), from.end(), to[k]) -
                                              from.begin())];
  }
  return out;
}

// Weights of a point that is in the triangle up to a tolerance.
std::array<double, 3> Inside(std::array<double, 3> weights) {
  double sum = 0;
  for (double& w : weights) sum += w = std::max(w, 0.0);
  for (double& w : weights) w /= sum;
  return weights;
}

}  // namespace

Located FromGiven(const RegisteredMeshParts& mesh, std::uint32_t given,
                  const std::array<double, 3>& barycentric) {
  const Triangle corners = mesh.repair.CornersOf(given);
  const Repair::Parts parts = mesh.repair.PartsOf(given);
  if (parts.size() == 1) {
    return {parts.begin, Reordered(corners, barycentric, mesh.mesh.triangles[parts.begin]), 0};
  }
  if (parts.size() == 0) {
    const auto heaviest = std::max_element(barycentric.begin(), barycentric.end());
    const std::uint32_t v = corners[static_cast<std::size_t>(heaviest - barycentric.begin())];
    Located place;
    for (std::uint32_t t = 0; t < mesh.mesh.triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        if (mesh.mesh.triangles[t][k] != v) continue;
        place.triangle = t;
        place.barycentric[k] = 1;
        return place;
      }
    }
    return place;
  }
  // The part that holds the point best: the split corners may lie a little beside the given sides.
  Complex p = 0;
  for (std::size_t k = 0; k < 3; ++k) p += barycentric[k] * mesh.rest[corners[k]];
  Located best;
  double most = 0;
  for (std::uint32_t t = parts.begin; t < parts.end; ++t) {
    const auto weights = Barycentric(Rests(mesh, mesh.mesh.triangles[t]), p);
    const double least = std::min({weights[0], weights[1], weights[2]});
    if (best.triangle != kNone && least <= most) continue;
    best = {t, Inside(weights), 0};
    most = least;
  }
  return best;
}

Located ToGiven(const RegisteredMeshParts& mesh, const Located& place) {
  Located out = place;
  if (!mesh.repair.changed()) {
    if (mesh.turned[place.triangle]) std::swap(out.barycentric[1], out.barycentric[2]);
    return out;
  }
  out.triangle = mesh.repair.TriangleOf(place.triangle);
  const Triangle corners = mesh.repair.CornersOf(out.triangle);
  const Triangle& own = mesh.mesh.triangles[place.triangle];
  if (mesh.repair.PartsOf(out.triangle).size() == 1) {
    out.barycentric = Reordered(own, place.barycentric, corners);
    return out;
  }
  Complex p = 0;
  for (std::size_t k = 0; k < 3; ++k) p += place.barycentric[k] * mesh.rest[own[k]];
  out.barycentric = Inside(Barycentric(Rests(mesh, corners), p));
  return out;
}

}  // namespace arap
