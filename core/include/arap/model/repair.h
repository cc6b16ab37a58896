// Repairs: what is mended of a mesh before it is used, where that is asked for.
#pragma once

#include <optional>

namespace arap {

// In this order. Vertices keep their numbers and places, and whatever is answered speaks of the
// vertices and triangles that were given.
struct RepairOptions {
  // Every vertex becomes the lowest one within the tolerance, of those that stay: twins along texture
  // seams, triangles with corners of their own. Triangles that collapse are left out.
  bool weld = false;
  // Of triangles with the same corners, whichever way they run, the lowest is kept.
  bool drop_duplicates = false;
  // A border edge that passes border vertices of its neighbours within the tolerance is split there.
  bool stitch = false;
  // How far apart is together: in units of the mesh, 0 to kMaxRepairTolerance of the diagonal of its
  // bounding box; below 1e-12 of it only what is equal. Nothing: kRepairTolerance of the diagonal.
  std::optional<double> tolerance = {};

  bool any() const { return weld || drop_duplicates || stitch; }
  bool operator==(const RepairOptions&) const = default;
};

// Parts of the diagonal.
inline constexpr double kRepairTolerance = 1e-6;
inline constexpr double kMaxRepairTolerance = 0.01;

}  // namespace arap
