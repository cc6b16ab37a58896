// Surfaces made in code. The developable ones are bent along straight rulings only and every
// triangle lies between two neighbouring rulings, so that they are isometric to the plane up to
// rounding.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "arap/model/mesh.h"

namespace arap::testing {

// A surface with its true flat positions (#V); triangles are counter-clockwise in the plane.
struct Developable {
  SurfaceMesh surface;
  std::vector<Complex> flat;
};

// A width × height sheet of nx × ny cells rolled up by `turns` full turns; may run through itself.
Developable RolledSheet(std::size_t nx, std::size_t ny, double width, double height, double turns,
                        std::uint64_t seed);

// A width × height sheet folded to and fro by `fold` radians at every one of its nx − 1 inner
// rulings.
Developable Accordion(std::size_t nx, std::size_t ny, double width, double height, double fold,
                      std::uint64_t seed);

// Part of a cone between two distances from the apex: `flat_angle` radians wide in the plane, wound
// by `space_angle` > flat_angle in space; both below 2π.
Developable ConePatch(std::size_t sectors, std::size_t rings, double inner, double outer,
                      double flat_angle, double space_angle, std::uint64_t seed);

// A cap of the unit sphere around the north pole down to `polar_angle` radians: not developable.
SurfaceMesh SphereCap(std::size_t rings, std::size_t sectors, double polar_angle);

// A whole sphere of radius 1 by latitude and longitude; closed, genus 0.
SurfaceMesh Sphere(std::size_t rings, std::size_t sectors);

// A torus around the z axis; closed, genus 1. `around` × `across` cells of two triangles.
SurfaceMesh Torus(std::size_t around, std::size_t across, double radius, double tube);

// A plate of (2·holes + 1) × 3 × 1 unit cubes with square holes through it; closed, of genus
// `holes`. Every unit square has `cells` × `cells` cells of two triangles.
SurfaceMesh PlateWithHoles(std::size_t holes, std::size_t cells);

// A band with a half twist of `n` cells along and one across, two vertices at every step.
SurfaceMesh MoebiusBand(std::size_t n);

// Both, the second moved by `shift`; vertices and triangles of the first come first.
SurfaceMesh Together(const SurfaceMesh& first, const SurfaceMesh& second,
                     const Eigen::Vector3d& shift);

}  // namespace arap::testing
