// CutField: a surface while automatic cuts are drawn on it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/cut/pieces.h"
#include "core/mesh/gluing.h"
#include "core/mesh/space.h"

namespace arap {

// Sides and vertices are those of the split surface. Cuts drawn here are kept apart from the open
// sides that were there before, so that they can be moved.
class CutField {
 public:
  // Refers to all three. O(#F).
  CutField(std::span<const Point3> input_vertices, const SplitVertices& split, Gluing& gluing);

  std::span<const Triangle> triangles() const { return split_.triangles; }
  std::size_t vertex_count() const { return split_.source.size(); }
  const Gluing& gluing() const { return gluing_; }
  std::uint32_t Start(std::uint32_t side) const { return SideStart(split_.triangles, side); }
  std::uint32_t End(std::uint32_t side) const { return SideEnd(split_.triangles, side); }

  // Open before anything was drawn.
  bool Rim(std::uint32_t side) const { return gluing_.open(side) && !drawn_[side]; }
  bool OnRim(std::uint32_t vertex) const { return on_rim_[vertex]; }
  // A side that starts at the vertex; on the rim if there is one.
  std::uint32_t Leaving(std::uint32_t vertex) const { return leaving_[vertex]; }
  bool Drawn(std::uint32_t side) const { return drawn_[side]; }
  void Draw(std::uint32_t side);
  void Erase(std::uint32_t side);
  // How many drawn edges end at a vertex.
  std::uint32_t Degree(std::uint32_t vertex) const { return degree_[vertex]; }

  // Has to come before the two that follow, for every piece to be cut. O(F).
  void Measure(const Piece& piece);

  // |2π − the angles around|, 0 on the rim, as a multiple of the mean over the piece. The mean is
  // taken to be at least 1 / #vertices, so that rounding on a flat surface counts for nothing.
  double Curvature(std::uint32_t vertex) const { return curvature_[vertex]; }

  // Length of an edge, down to a quarter of it where the curvature is high. 0 and more.
  double Cost(std::uint32_t side) const { return cost_[side]; }

  // Calls visit(side) for every side that leaves the vertex and is not on the rim.
  template <class Visit>
  void ForEachLeaving(std::uint32_t vertex, Visit visit) const {
    const std::uint32_t first = leaving_[vertex];
    std::uint32_t side = first;
    do {
      if (!Rim(side)) visit(side);
      const std::uint32_t arriving = PreviousSide(side);
      if (Rim(arriving)) break;
      side = gluing_.mate[arriving];
    } while (side != first);
  }

 private:
  Eigen::Map<const Eigen::Vector3d> Position(std::uint32_t vertex) const {
    return Vec(input_[split_.source[vertex]]);
  }

  std::span<const Point3> input_;
  const SplitVertices& split_;
  Gluing& gluing_;
  std::vector<bool> drawn_;             // 3·#F
  std::vector<std::uint32_t> leaving_;  // #V
  std::vector<std::uint32_t> degree_;   // #V
  std::vector<double> curvature_;       // #V
  std::vector<double> cost_;            // 3·#F
  std::vector<bool> on_rim_;            // #V
};

}  // namespace arap
