#include "core/cut/cut_field.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace arap {
namespace {

// Curvature beyond this multiple of the mean makes a place no better.
constexpr double kHigh = 3;

}  // namespace

CutField::CutField(std::span<const Point3> input_vertices, const SplitVertices& split,
                   Gluing& gluing)
    : input_(input_vertices),
      split_(split),
      gluing_(gluing),
      drawn_(gluing.mate.size(), false),
      leaving_(split.source.size(), kNone),
      degree_(split.source.size(), 0),
      curvature_(split.source.size(), 0),
      cost_(gluing.mate.size(), 0),
      on_rim_(split.source.size(), false) {
  for (std::uint32_t side = 0; side < gluing.mate.size(); ++side) {
    std::uint32_t& leaving = leaving_[Start(side)];
    if (leaving == kNone || gluing.open(side)) leaving = side;
    if (gluing.open(side)) on_rim_[Start(side)] = true;
  }
}

void CutField::Draw(std::uint32_t side) {
  gluing_.Cut(side);
  drawn_[side] = drawn_[gluing_.mate[side]] = true;
  ++degree_[Start(side)], ++degree_[End(side)];
}

void CutField::Erase(std::uint32_t side) {
  gluing_.Join(side);
  drawn_[side] = drawn_[gluing_.mate[side]] = false;
  --degree_[Start(side)], --degree_[End(side)];
}

void CutField::Measure(const Piece& piece) {
  for (const std::uint32_t v : piece.vertices) curvature_[v] = 2 * std::numbers::pi;
  for (const std::uint32_t t : piece.triangles) {
    const Triangle& c = split_.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3d a = Position(c[(k + 1) % 3]) - Position(c[k]);
      const Eigen::Vector3d b = Position(c[(k + 2) % 3]) - Position(c[k]);
      curvature_[c[k]] -= std::atan2(a.cross(b).norm(), a.dot(b));
    }
  }
  double total = 0;
  for (const std::uint32_t v : piece.vertices) {
    curvature_[v] = OnRim(v) ? 0 : std::abs(curvature_[v]);
    total += curvature_[v];
  }
  const double mean = std::max(total, 1.0) / static_cast<double>(piece.vertices.size());
  for (const std::uint32_t v : piece.vertices) curvature_[v] /= mean;
  const auto discount = [this](std::uint32_t v) {
    return 1 / (1 + std::min(curvature_[v], kHigh));
  };
  for (const std::uint32_t t : piece.triangles) {
    for (std::uint32_t side = 3 * t; side < 3 * t + 3; ++side) {
      const std::uint32_t a = Start(side), b = End(side);
      cost_[side] = 0.5 * (discount(a) + discount(b)) * (Position(b) - Position(a)).norm();
    }
  }
}

}  // namespace arap
