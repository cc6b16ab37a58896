#include "core/energy/build_cells.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace arap {
namespace {

double Cotangent(Complex a, Complex b) {
  const Complex z = std::conj(a) * b;
  return z.real() / z.imag();
}

double Rigidity(const EnergyOptions& options, std::uint32_t triangle) {
  return options.rigidity.empty() ? 1.0 : options.rigidity[triangle];
}

// The corner of `triangle` that holds `vertex`.
std::size_t CornerOf(const Triangle& triangle, std::uint32_t vertex) {
  return triangle[0] == vertex ? 0 : triangle[1] == vertex ? 1 : 2;
}

class Builder {
 public:
  Builder(const std::vector<Triangle>& triangles, const Topology& topology,
          const EnergyOptions& options, const TriangleFrame& frame)
      : triangles_(triangles), topology_(topology), options_(options), frame_(frame) {}

  // One cell per directed edge, half weight each; or only from the lower to the higher vertex.
  void AddEdgeCells(bool both) {
    const std::vector<double> weights = EdgeWeights();
    for (std::size_t e = 0; e < topology_.edges.size(); ++e) {
      const Edge& edge = topology_.edges[e];
      if (both) {
        AddEdgeCell(edge, edge.v0, edge.v1, 0.5 * weights[e]);
        AddEdgeCell(edge, edge.v1, edge.v0, 0.5 * weights[e]);
      } else {
        AddEdgeCell(edge, edge.v0, edge.v1, weights[e]);
      }
    }
  }

  void AddFaceCells() {
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      const Triangle& c = triangles_[t];
      const auto p = frame_(t);
      std::array<CellEdge, 3> edges;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
        const double weight =
            options_.weights == Weights::kUniform ? 0.5 : 0.5 * Cotangent(p[i] - p[k], p[j] - p[k]);
        edges[k] = {c[i], c[j], p[j] - p[i], weight * Rigidity(options_, t)};
      }
      system_.cells.Add(edges, edges);
    }
  }

  // One cell per vertex: its spokes, which each share with the cell at the other end.
  void AddVertexCells() {
    const std::vector<double> weights = EdgeWeights();
    std::vector<std::vector<CellEdge>> spokes(topology_.vertex_component.size());
    for (std::size_t e = 0; e < topology_.edges.size(); ++e) {
      const Edge& edge = topology_.edges[e];
      const Complex rest = RestVector(edge);
      spokes[edge.v0].push_back({edge.v0, edge.v1, rest, 0.5 * weights[e]});
      spokes[edge.v1].push_back({edge.v1, edge.v0, -rest, 0.5 * weights[e]});
    }
    for (const auto& star : spokes) {
      if (!star.empty()) system_.cells.Add(star, star);
    }
  }

  void WeldJoints() {
    for (const std::uint32_t joint : topology_.joints) {
      std::vector<CellEdge> spokes;
      for (const Edge& edge : topology_.edges) {
        const Complex rest = RestVector(edge);
        if (edge.v0 == joint) spokes.push_back({edge.v0, edge.v1, rest, 0.5});
        if (edge.v1 == joint) spokes.push_back({edge.v1, edge.v0, -rest, 0.5});
      }
      system_.cells.Add(spokes, spokes);
    }
  }

  CellSystem Take() { return std::move(system_); }

 private:
  // From v0 to v1 in the frame of the edge's first triangle.
  Complex RestVector(const Edge& edge) const {
    const Triangle& c = triangles_[edge.triangle[0]];
    const auto p = frame_(edge.triangle[0]);
    return p[CornerOf(c, edge.v1)] - p[CornerOf(c, edge.v0)];
  }

  // Weight of every edge [II09 §6]: 1, or half the cotangents of its opposite angles; times
  // rigidity.
  std::vector<double> EdgeWeights() {
    std::vector<double> weights(topology_.edges.size(), 0.0);
    for (std::size_t e = 0; e < weights.size(); ++e) {
      const Edge& edge = topology_.edges[e];
      const std::size_t sides = edge.boundary() ? 1 : 2;
      double cotangents = 0, rigid_cotangents = 0, rigidity = 0;
      for (std::size_t side = 0; side < sides; ++side) {
        const std::uint32_t t = edge.triangle[side];
        rigidity += Rigidity(options_, t) / static_cast<double>(sides);
        if (options_.weights == Weights::kUniform) continue;
        const auto p = frame_(t);
        const std::size_t k = CornerOf(triangles_[t], edge.opposite[side]);
        const double cot = 0.5 * Cotangent(p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
        cotangents += cot;
        rigid_cotangents += cot * Rigidity(options_, t);
      }
      if (options_.weights == Weights::kUniform) {
        weights[e] = rigidity;
      } else if (cotangents < kMinCotangent) {
        weights[e] = kMinCotangent * rigidity;
        ++system_.clamped;
      } else {
        weights[e] = std::max(rigid_cotangents, kMinCotangent * rigidity);
      }
    }
    return weights;
  }

  // The hinge of i→j: each triangle keeps its own side of the edge, the one its orientation says.
  void AddEdgeCell(const Edge& edge, std::uint32_t i, std::uint32_t j, double weight) {
    std::array<CellEdge, 3> fit;
    std::size_t count = 0;
    Complex along;  // v_j − v_i in the frame of the first triangle; later triangles turn onto it
    for (std::size_t side = 0; side < 2 && edge.triangle[side] != kNone; ++side) {
      const Triangle& c = triangles_[edge.triangle[side]];
      const auto p = frame_(edge.triangle[side]);
      const std::size_t ci = CornerOf(c, i);
      const Complex ij = p[CornerOf(c, j)] - p[ci];
      Complex opposite = p[CornerOf(c, edge.opposite[side])] - p[ci];
      if (side == 0) {
        along = ij;
        fit[count++] = {i, j, along, 1.0};
      } else {
        opposite *= along * std::conj(ij) / std::norm(ij);
      }
      fit[count++] = {i, edge.opposite[side], opposite, 1.0};
    }
    const std::array<CellEdge, 1> energy{CellEdge{i, j, along, weight}};
    system_.cells.Add(std::span(fit).first(count), energy);
  }

  const std::vector<Triangle>& triangles_;
  const Topology& topology_;
  const EnergyOptions& options_;
  const TriangleFrame& frame_;
  CellSystem system_;
};

}  // namespace

Status CheckEnergyOptions(const EnergyOptions& options, std::size_t triangles) {
  const auto& rigidity = options.rigidity;
  if (rigidity.empty()) return {};
  if (rigidity.size() != triangles) {
    Fault fault{
        FaultKind::kArrayLength,
        fmt::format("rigidity has {} numbers; it needs 0 or one for each of the {} triangles",
                    rigidity.size(), triangles),
        {},
        {},
        "energy.rigidity"};
    fault.Detail("length", fmt::to_string(rigidity.size()))
        .Detail("expected", fmt::to_string(triangles));
    return Fail(std::move(fault));
  }
  for (std::uint32_t t = 0; t < rigidity.size(); ++t) {
    if (rigidity[t] > 0 && rigidity[t] <= kMaxRigidity) continue;
    return Fail(
        Fault{FaultKind::kInvalidOption,
              fmt::format("the rigidity of triangle {} is {}; it must be above 0 and at most {}", t,
                          rigidity[t], kMaxRigidity),
              {t},
              {{"limit", fmt::to_string(kMaxRigidity)}},
              "energy.rigidity"});
  }
  return {};
}

Result<CellSystem> BuildCells(const std::vector<Triangle>& triangles, const Topology& topology,
                              const EnergyOptions& options, const TriangleFrame& frame,
                              bool planar) {
  if (auto ok = CheckEnergyOptions(options, triangles.size()); !ok) return Fail(ok.error());
  if (options.basis == Basis::kVertex && !planar) {
    return Fail(Fault{FaultKind::kInvalidOption,
                      "VERTEX cells are for planar meshes; a surface takes EDGE or FACE cells",
                      {},
                      {},
                      "energy.basis"});
  }
  Builder builder(triangles, topology, options, frame);
  switch (options.basis) {
    case Basis::kEdge:
      builder.AddEdgeCells(true);
      break;
    case Basis::kEdgeAsPublished:
      builder.AddEdgeCells(false);
      break;
    case Basis::kFace:
      builder.AddFaceCells();
      break;
    case Basis::kVertex:
      builder.AddVertexCells();
      break;
  }
  if (planar && options.basis != Basis::kVertex) builder.WeldJoints();
  return builder.Take();
}

}  // namespace arap
