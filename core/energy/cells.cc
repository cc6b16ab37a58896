#include "core/energy/cells.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "core/base/try.h"

namespace arap {
namespace {

template <class... Columns>
std::size_t BytesOf(const Columns&... columns) {
  return ((columns.capacity() * sizeof(columns[0])) + ...);
}

// How many spokes a weld may have before it is made of several, and then takes of each piece.
constexpr std::size_t kWeldSpokes = 64;
constexpr std::size_t kWeldSpokesOfAPiece = 8;

// Numbers that the stars of all VERTEX cells may put into the matrix: a regular mesh has 49 for
// every vertex, and one vertex with 2,000 edges is still good.
constexpr std::size_t kStarNumbers = 4'000'000;
constexpr std::size_t kStarNumbersOfAVertex = 128;

// Of a vertex. Their numbers stay far below 2^30 (MeshLimits).
std::int32_t BeginOf(std::uint32_t vertex) { return static_cast<std::int32_t>(2 * vertex); }

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
          const EnergyOptions& options, const TriangleFrame& frame,
          const std::vector<bool>& left_out)
      : triangles_(triangles),
        topology_(topology),
        options_(options),
        frame_(frame),
        left_out_(left_out) {}

  // One cell per directed edge, half weight each; or only from the lower to the higher vertex.
  void AddEdgeCells(bool both) {
    const std::vector<double> weights = EdgeWeights();
    HingeTable& hinges = system_.cells.hinges;
    hinges.both = both;
    const auto first = [&](std::uint32_t e) { return topology_.edges[e].v0; };
    for (const std::uint32_t e : ByComponent(topology_.edges.size(), first)) {
      AddHinge(topology_.edges[e], both ? 0.5 * weights[e] : weights[e]);
      Extend(hinges.runs, hinges.size(), first(e));
    }
  }

  void AddFaceCells() {
    FaceTable& faces = system_.cells.faces;
    faces.Resize(triangles_.size());
    std::size_t made = 0;
    const auto first = [&](std::uint32_t t) { return triangles_[t][0]; };
    for (const std::uint32_t t : ByComponent(triangles_.size(), first)) {
      const auto p = frame_(t);
      double w[3];
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
        double weight = 0.5;
        if (LeftOut(t)) {
          weight = 0.5 * kMinCotangent;
        } else if (options_.weights == Weights::kCotangent) {
          weight = 0.5 * Cotangent(p[i] - p[k], p[j] - p[k]);
        }
        w[k] = weight * Rigidity(options_, t);
      }
      faces.Set(made++, triangles_[t], p[1] - p[0], p[2] - p[0], w);
      Extend(faces.runs, made, first(t));
    }
  }

  // One cell per vertex: its spokes, which each share with the cell at the other end.
  void AddVertexCells() {
    const std::vector<double> weights = EdgeWeights();
    std::vector<std::vector<Spoke>> spokes(topology_.vertex_component.size());
    for (std::size_t e = 0; e < topology_.edges.size(); ++e) {
      const Edge& edge = topology_.edges[e];
      const Complex rest = RestVector(edge);
      spokes[edge.v0].push_back({edge.v0, edge.v1, rest, 0.5 * weights[e]});
      spokes[edge.v1].push_back({edge.v1, edge.v0, -rest, 0.5 * weights[e]});
    }
    for (const auto& star : spokes) {
      if (!star.empty()) AddStar(star);
    }
  }

  void WeldJoints() {
    if (topology_.joints.empty()) return;
    std::vector<std::uint32_t> number(topology_.vertex_component.size(), kNone);
    for (std::uint32_t j = 0; j < topology_.joints.size(); ++j) number[topology_.joints[j]] = j;
    std::vector<std::vector<PieceSpoke>> at(topology_.joints.size());
    for (const Edge& edge : topology_.edges) {
      const std::uint32_t piece = topology_.triangle_piece[edge.triangle[0]];
      for (const auto& [from, to] : {std::pair(edge.v0, edge.v1), std::pair(edge.v1, edge.v0)}) {
        if (number[from] == kNone) continue;
        const Complex rest = from == edge.v0 ? RestVector(edge) : -RestVector(edge);
        at[number[from]].push_back({{from, to, rest, 0.5}, piece});
      }
    }
    for (std::vector<PieceSpoke>& spokes : at) Weld(spokes);
  }

  CellSystem Take() { return std::move(system_); }

 private:
  bool LeftOut(std::uint32_t t) const { return !left_out_.empty() && left_out_[t]; }

  // The numbers below `count`, those of one component together, otherwise in order.
  template <class VertexOf>
  std::vector<std::uint32_t> ByComponent(std::size_t count, VertexOf vertex_of) const {
    std::vector<std::uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0u);
    if (topology_.components > 1) {
      std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return topology_.vertex_component[vertex_of(a)] < topology_.vertex_component[vertex_of(b)];
      });
    }
    return order;
  }

  // Counts the last cell of a table, which holds `vertex`, to the run of its component.
  void Extend(std::vector<CellRun>& runs, std::size_t size, std::uint32_t vertex) const {
    const std::uint32_t component =
        topology_.components > 1 ? topology_.vertex_component[vertex] : 0;
    if (runs.empty() || runs.back().component != component) {
      runs.push_back({size - 1, size - 1, component});
    }
    runs.back().end = size;
  }

  struct PieceSpoke {
    Spoke spoke;
    std::uint32_t piece = 0;
  };

  // The pieces round one joint share a star. A large star would be a dense block of the matrix:
  // there every two neighbouring pieces share one, with a few spokes of each.
  void Weld(std::vector<PieceSpoke>& spokes) {
    std::vector<Spoke> star;
    if (spokes.size() <= kWeldSpokes) {
      for (const PieceSpoke& s : spokes) star.push_back(s.spoke);
      return AddStar(star);
    }
    std::stable_sort(spokes.begin(), spokes.end(),
                     [](const PieceSpoke& a, const PieceSpoke& b) { return a.piece < b.piece; });
    std::size_t before = 0;  // spokes in `star` that are of the piece before
    for (std::size_t begin = 0, end = 0; begin < spokes.size(); begin = end) {
      while (end < spokes.size() && spokes[end].piece == spokes[begin].piece) ++end;
      star.erase(star.begin(), star.begin() + static_cast<std::ptrdiff_t>(before));
      before = star.size();
      const std::size_t take = std::min(end - begin, kWeldSpokesOfAPiece);
      for (std::size_t i = 0; i < take; ++i) {
        star.push_back(spokes[begin + i * (end - begin) / take].spoke);
      }
      if (before > 0) AddStar(star);
    }
  }

  void AddStar(const std::vector<Spoke>& star) {
    StarTable& stars = system_.cells.stars;
    stars.Add(star);
    Extend(stars.runs, stars.size(), star.front().a);
  }

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
        if (options_.weights == Weights::kUniform || LeftOut(t)) continue;
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

  // The hinge of an edge: each triangle keeps its own side, the one its orientation says, and the
  // second is laid against the edge of the first.
  void AddHinge(const Edge& edge, double weight) {
    const std::uint32_t i = edge.v0, j = edge.v1;
    std::array<Complex, 2> opposite{0, 0};
    Complex along = 0;
    for (std::size_t side = 0; side < 2 && edge.triangle[side] != kNone; ++side) {
      const Triangle& c = triangles_[edge.triangle[side]];
      const auto p = frame_(edge.triangle[side]);
      const std::size_t ci = CornerOf(c, i);
      const Complex ij = p[CornerOf(c, j)] - p[ci];
      opposite[side] = p[CornerOf(c, edge.opposite[side])] - p[ci];
      if (side == 0) {
        along = ij;
      } else {
        opposite[side] *= along * std::conj(ij) / std::norm(ij);
      }
    }
    system_.cells.hinges.Add(i, j, edge.opposite[0], edge.boundary() ? j : edge.opposite[1], along,
                             opposite[0], opposite[1], weight);
  }

  const std::vector<Triangle>& triangles_;
  const Topology& topology_;
  const EnergyOptions& options_;
  const TriangleFrame& frame_;
  const std::vector<bool>& left_out_;
  CellSystem system_;
};

// A star is a dense block of the matrix: those of a mesh must not be many numbers more than it has.
Status CheckStars(const Topology& topology) {
  std::vector<std::size_t> spokes(topology.vertex_component.size(), 0);
  for (const Edge& edge : topology.edges) ++spokes[edge.v0], ++spokes[edge.v1];
  std::size_t numbers = 0;
  for (const std::size_t k : spokes) numbers += (k + 1) * (k + 1);
  const std::size_t limit = kStarNumbers + kStarNumbersOfAVertex * spokes.size();
  if (numbers <= limit) return {};
  const auto most = std::max_element(spokes.begin(), spokes.end());
  const auto vertex = static_cast<std::uint32_t>(most - spokes.begin());
  return Fail(Fault(FaultKind::kInvalidOption,
                    fmt::format("Vertex {} has {} edges, too many for VERTEX cells, whose matrix "
                                "would have {} numbers and may have {}; take EDGE or FACE cells.",
                                vertex, *most, numbers, limit))
                  .Field("energy.basis")
                  .Element(vertex)
                  .Detail("count", numbers)
                  .Detail("limit", limit));
}

}  // namespace

void HingeTable::Add(std::uint32_t from, std::uint32_t to, std::uint32_t left_vertex,
                     std::uint32_t right_vertex, Complex to_j, Complex to_left, Complex to_right,
                     double w) {
  i.push_back(BeginOf(from));
  j.push_back(BeginOf(to));
  left.push_back(BeginOf(left_vertex));
  right.push_back(BeginOf(right_vertex));
  along_x.push_back(to_j.real());
  along_y.push_back(to_j.imag());
  left_x.push_back(to_left.real());
  left_y.push_back(to_left.imag());
  right_x.push_back(to_right.real());
  right_y.push_back(to_right.imag());
  weight.push_back(w);
}

void FaceTable::Resize(std::size_t triangles) {
  for (auto* column : {&v0, &v1, &v2}) column->resize(triangles);
  for (auto* column : {&e1_x, &e1_y, &e2_x, &e2_y, &weight0, &weight1, &weight2}) {
    column->resize(triangles);
  }
}

void FaceTable::Set(std::size_t t, const Triangle& triangle, Complex to_1, Complex to_2,
                    const double (&w)[3]) {
  v0[t] = static_cast<std::int32_t>(triangle[0]);
  v1[t] = static_cast<std::int32_t>(triangle[1]);
  v2[t] = static_cast<std::int32_t>(triangle[2]);
  e1_x[t] = to_1.real();
  e1_y[t] = to_1.imag();
  e2_x[t] = to_2.real();
  e2_y[t] = to_2.imag();
  weight0[t] = w[0];
  weight1[t] = w[1];
  weight2[t] = w[2];
}

void StarTable::Add(std::span<const Spoke> star) {
  double sum = 0;
  for (const Spoke& s : star) sum += s.weight * std::norm(s.rest);
  spokes.insert(spokes.end(), star.begin(), star.end());
  begin.push_back(static_cast<std::uint32_t>(spokes.size()));
  size_of.push_back(sum);
}

std::size_t Cells::bytes() const {
  const HingeTable& h = hinges;
  const FaceTable& f = faces;
  const StarTable& s = stars;
  return BytesOf(h.i, h.j, h.left, h.right, h.along_x, h.along_y, h.left_x, h.left_y, h.right_x,
                 h.right_y, h.weight, h.runs) +
         BytesOf(f.v0, f.v1, f.v2, f.e1_x, f.e1_y, f.e2_x, f.e2_y, f.weight0, f.weight1, f.weight2,
                 f.runs) +
         BytesOf(s.begin, s.spokes, s.size_of, s.runs);
}

Warning ClampedWarning(std::size_t edges) {
  return {
      "clamped_weights",
      edges,
      {},
      fmt::format("{} edges have a cotangent weight too small or negative for this basis; it was "
                  "raised",
                  edges)};
}

Status CheckEnergyOptions(const EnergyOptions& options, std::size_t triangles) {
  const auto& rigidity = options.rigidity;
  if (rigidity.empty()) return {};
  if (rigidity.size() != triangles) {
    return Fail(Fault(FaultKind::kArrayLength,
                      fmt::format("energy.rigidity has {} numbers for {} triangles.",
                                  rigidity.size(), triangles))
                    .Field("energy.rigidity")
                    .Detail("length", rigidity.size())
                    .Detail("expected", triangles));
  }
  for (std::uint32_t t = 0; t < rigidity.size(); ++t) {
    if (rigidity[t] > 0 && rigidity[t] <= kMaxRigidity) continue;
    return Fail(
        Fault(FaultKind::kInvalidOption,
              fmt::format("The rigidity of triangle {} is {}; it must be above 0 and at most {}.",
                          t, rigidity[t], kMaxRigidity))
            .Field("energy.rigidity")
            .Element(t)
            .Detail("value", rigidity[t])
            .Detail("limit", kMaxRigidity));
  }
  return {};
}

Result<CellSystem> BuildCells(const std::vector<Triangle>& triangles, const Topology& topology,
                              const EnergyOptions& options, const TriangleFrame& frame, bool planar,
                              const std::vector<bool>& left_out) {
  CHECK_OK(CheckEnergyOptions(options, triangles.size()));
  if (options.basis == Basis::kVertex && !planar) {
    return Fail(Fault(FaultKind::kInvalidOption,
                      "VERTEX cells are for planar meshes; a surface takes EDGE or FACE cells.")
                    .Field("energy.basis"));
  }
  if (options.basis == Basis::kVertex) CHECK_OK(CheckStars(topology));
  Builder builder(triangles, topology, options, frame, left_out);
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
