// Points of space for computing with: the arrays of the model seen as vectors.
#pragma once

#include <cstdint>
#include <span>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "arap/model/mesh.h"

namespace arap {

// A view: valid as long as the point.
inline Eigen::Map<const Eigen::Vector3d> Vec(const Point3& point) {
  return Eigen::Map<const Eigen::Vector3d>(point.data());
}

// Twice the area of a triangle, never negative.
inline double TwiceArea(const Point3& a, const Point3& b, const Point3& c) {
  return (Vec(b) - Vec(a)).cross(Vec(c) - Vec(a)).norm();
}

// The diagonal of the box round the corners of triangles, 0 without any.
inline double DiagonalOf(std::span<const Point3> points, std::span<const Triangle> triangles) {
  Eigen::AlignedBox3d box;
  for (const Triangle& t : triangles) {
    for (const std::uint32_t v : t) box.extend(Vec(points[v]));
  }
  return box.isEmpty() ? 0 : box.diagonal().norm();
}

// The centre of mass of the triangles, weighed by their area. NaN where none has any.
inline Eigen::Vector3d AreaCentroid(const SurfaceMesh& mesh) {
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  double area = 0;
  for (const Triangle& t : mesh.triangles) {
    const Point3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const double weight = TwiceArea(a, b, c);
    centroid += weight / 3 * (Vec(a) + Vec(b) + Vec(c));
    area += weight;
  }
  return centroid / area;
}

inline Point3 ToPoint3(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace arap
