#include "core/flatten/disk.h"

#include <limits>

#include <fmt/format.h>

namespace arap {
namespace {

// Symmetric surfaces have several edges at one distance; rounding must not choose among them.
constexpr double kTie = 1e-9;

}  // namespace

Status CheckDisk(const Topology& topology, std::size_t vertices, std::size_t triangles) {
  const auto used = static_cast<std::int64_t>(vertices - topology.unreferenced);
  const std::int64_t euler = used - static_cast<std::int64_t>(topology.edges.size()) +
                             static_cast<std::int64_t>(triangles);
  std::string what;
  if (topology.components != 1) {
    what = fmt::format("it has {} connected components", topology.components);
  } else if (topology.pieces != 1) {
    what = fmt::format("its parts touch in a single vertex, the first is vertex {}",
                       topology.joints.front());
  } else if (topology.boundary_loops == 0) {
    what = "it is closed";
  } else if (topology.boundary_loops != 1) {
    what = fmt::format("it has {} boundaries", topology.boundary_loops);
  } else if (euler != 1) {
    what = fmt::format("its Euler characteristic is {} instead of 1", euler);
  } else {
    return {};
  }
  Fault fault{FaultKind::kNotADisk, "the surface is not a disk: " + what, {}, {}, "mesh.triangles"};
  fault.Detail("components", fmt::to_string(topology.components))
      .Detail("boundary_loops", fmt::to_string(topology.boundary_loops))
      .Detail("euler_characteristic", fmt::to_string(euler));
  return Fail(std::move(fault));
}

std::uint32_t CentreEdge(const SurfaceMesh& mesh, const Topology& topology) {
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  double area = 0;
  for (const Triangle& t : mesh.triangles) {
    const Eigen::Vector3d &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]],
                          &c = mesh.vertices[t[2]];
    const double weight = (b - a).cross(c - a).norm();
    centroid += weight / 3 * (a + b + c);
    area += weight;
  }
  centroid /= area;
  std::uint32_t best = 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::uint32_t e = 0; e < topology.edges.size(); ++e) {
    const Edge& edge = topology.edges[e];
    const double distance =
        (0.5 * (mesh.vertices[edge.v0] + mesh.vertices[edge.v1]) - centroid).squaredNorm();
    if (distance < nearest - kTie) best = e, nearest = distance;
  }
  return best;
}

}  // namespace arap
