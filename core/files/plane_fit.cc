#include "core/files/plane_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <fmt/format.h>

namespace arap {
namespace {

constexpr const char* kAxes[] = {"x", "y", "z"};

Eigen::Map<const Eigen::Vector3d> At(const Point3& point) {
  return Eigen::Map<const Eigen::Vector3d>(point.data());
}

// The two axes beside one.
std::array<std::size_t, 2> Beside(std::size_t axis) {
  return {axis == 0 ? std::size_t{1} : 0, axis == 2 ? std::size_t{1} : 2};
}

// Axes of a plane: places are u·p and v·p.
struct Axes {
  Eigen::Vector3d u, v, normal;
};

Axes AxesOf(const Eigen::Vector3d& normal) {
  Eigen::Index across = 0;
  normal.cwiseAbs().maxCoeff(&across);
  const auto [first, second] = Beside(static_cast<std::size_t>(across));
  Axes axes;
  axes.normal = normal;
  const Eigen::Vector3d along = Eigen::Vector3d::Unit(static_cast<Eigen::Index>(first));
  axes.u = (along - along.dot(normal) * normal).normalized();
  axes.v = normal.cross(axes.u);
  if (axes.v[static_cast<Eigen::Index>(second)] < 0) axes.v = -axes.v;
  return axes;
}

// Of the plane that fits best, in units of `size`. The middle is that of the vertices.
Eigen::Vector3d BestNormal(const std::vector<Point3>& points, const Eigen::Vector3d& middle,
                           double size) {
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Point3& point : points) {
    const Eigen::Vector3d arm = (At(point) - middle) / size;
    spread += arm * arm.transpose();
  }
  // Eigenvalues come in ascending order.
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(0);
}

Warning Note(std::string message) { return {"plane", 1, {}, std::move(message)}; }

}  // namespace

Result<PlaneFit> FitPlane(SurfaceMesh mesh) {
  PlaneFit fit;
  fit.mesh.triangles = std::move(mesh.triangles);
  Eigen::AlignedBox3d box;
  for (const Point3& point : mesh.vertices) box.extend(At(point));
  if (box.isEmpty()) return fit;
  const Eigen::Vector3d thickness = box.sizes();
  const double size = thickness.norm();
  for (const std::size_t across : {std::size_t{2}, std::size_t{1}, std::size_t{0}}) {
    const double thick = thickness[static_cast<Eigen::Index>(across)];
    // A mesh that is too large to be measured is in a plane of the axes exactly or not at all.
    const bool flat = thick == 0 || (std::isfinite(size) && thick / 2 <= kPlaneTolerance * size);
    if (!flat) continue;
    const auto [first, second] = Beside(across);
    for (const Point3& point : mesh.vertices) {
      fit.mesh.vertices.emplace_back(point[first], point[second]);
    }
    std::string note;
    if (across != 2) {
      note = fmt::format("the mesh lies in the plane of {0} and {1}: its {0} and {1} are taken",
                         kAxes[first], kAxes[second]);
    }
    if (thick != 0) {
      note += fmt::format("{}{} differs by {:.2g} and is dropped", note.empty() ? "" : "; ",
                          kAxes[across], thick);
    }
    if (!note.empty()) fit.notes.push_back(Note(std::move(note)));
    return fit;
  }

  if (!std::isfinite(size)) {
    return Fail(
        Fault(FaultKind::kInvalidOption, "not in a plane: the mesh is too large to be measured")
            .Field("mesh.vertices"));
  }
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Point3& point : mesh.vertices) {
    middle += At(point) / static_cast<double>(mesh.vertices.size());
  }
  const Axes axes = AxesOf(BestNormal(mesh.vertices, middle, size));
  double worst = 0;
  std::uint32_t farthest = 0;
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    const Eigen::Map<const Eigen::Vector3d> p = At(mesh.vertices[v]);
    const double off = std::abs((p - middle).dot(axes.normal));
    if (off > worst) worst = off, farthest = v;
    fit.mesh.vertices.emplace_back(axes.u.dot(p), axes.v.dot(p));
  }
  if (!(worst <= kPlaneTolerance * size)) {
    const Point3& p = mesh.vertices[farthest];
    return Fail(
        Fault(FaultKind::kInvalidOption,
              fmt::format("not in a plane: vertex {} at ({:.6g}, {:.6g}, {:.6g}) lies {:.3g} "
                          "off the plane that fits best, more than {:g} of the size of "
                          "{:.6g}",
                          farthest, p[0], p[1], p[2], worst, kPlaneTolerance, size))
            .Field("mesh.vertices")
            .Element(farthest)
            .Detail("distance", worst));
  }
  fit.notes.push_back(Note(fmt::format(
      "the mesh lies in a plane across ({:.4g}, {:.4g}, {:.4g}): places are counted in it along "
      "({:.4g}, {:.4g}, {:.4g}) and ({:.4g}, {:.4g}, {:.4g})",
      axes.normal[0], axes.normal[1], axes.normal[2], axes.u[0], axes.u[1], axes.u[2], axes.v[0],
      axes.v[1], axes.v[2])));
  return fit;
}

}  // namespace arap
