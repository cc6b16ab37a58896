#include "core/cut/cut_surface.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/base/try.h"
#include "core/cut/cut_field.h"
#include "core/cut/cut_graph.h"
#include "core/cut/pieces.h"
#include "core/cut/shorten.h"
#include "core/mesh/defects.h"
#include "core/mesh/gluing.h"
#include "core/mesh/space.h"

namespace arap {
namespace {

// The edges that the caller wants cut.
struct Seams {
  std::vector<std::span<const Side>> edges;  // in the order given, each once, all its sides
  std::vector<std::uint32_t> on_boundary;    // entries that name an edge of one triangle
};

// kUnknownEdge for an entry that is no edge. The spans point into `sides` (SortedSides).
Result<Seams> FindSeams(std::span<const std::array<std::uint32_t, 2>> entries,
                        std::span<const Side> sides) {
  Seams seams;
  std::vector<bool> taken(entries.empty() ? 0 : sides.size(), false);  // the first side of an edge
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const auto [low, high] = std::minmax(entries[i][0], entries[i][1]);
    const Side wanted{low, high, 0};
    const auto begin = std::lower_bound(
        sides.begin(), sides.end(), wanted,
        [](const Side& a, const Side& b) { return a.v0 != b.v0 ? a.v0 < b.v0 : a.v1 < b.v1; });
    if (begin == sides.end() || !begin->SameEdge(wanted)) {
      return Fail(Fault(FaultKind::kUnknownEdge,
                        fmt::format("A seam runs from vertex {} to vertex {}, which is no edge of "
                                    "the mesh.",
                                    entries[i][0], entries[i][1]))
                      .Field(fmt::format("seams[{}]", i))
                      .Elements({entries[i][0], entries[i][1]}));
    }
    const auto first = static_cast<std::size_t>(begin - sides.begin());
    if (taken[first]) continue;
    taken[first] = true;
    auto end = begin;
    while (end != sides.end() && end->SameEdge(wanted)) ++end;
    if (end - begin == 1) {
      seams.on_boundary.push_back(static_cast<std::uint32_t>(i));
    } else {
      seams.edges.emplace_back(begin, end);
    }
  }
  return seams;
}

// Cuts `gluing` until every piece is a disk. `split` and `pieces` belong to it as it comes. Returns
// the lower side of every edge that was cut, ascending. O(#F log #F).
Result<std::vector<std::uint32_t>> CutToDisks(std::span<const Point3> input_vertices,
                                              const SplitVertices& split,
                                              std::span<const Piece> pieces, Gluing& gluing,
                                              const CancelToken& cancel) {
  CutField field(input_vertices, split, gluing);
  CutGraph graph(field, cancel);
  CutShortener shortener(field, cancel);
  for (const Piece& piece : pieces) {
    if (piece.disk()) continue;
    CHECK_OK(cancel.Check());
    field.Measure(piece);
    TRY(const auto ends, graph.Draw(piece));
    CHECK_OK(shortener.Shorten(piece, ends));
  }
  std::vector<std::uint32_t> cut;
  for (std::uint32_t side = 0; side < gluing.mate.size(); ++side) {
    if (field.Drawn(side) && side < gluing.mate[side]) cut.push_back(side);
  }
  return cut;
}

// Adds to the sentence of a fault what the caller can do about it.
Fault Advised(Fault fault, std::string_view advice) {
  if (fault.message.ends_with('.')) fault.message.pop_back();
  fault.message += fmt::format("; {}.", advice);
  return fault;
}

// Cuts one surface step by step: its triangles, turned as far as is known, and what joins them.
class Cutter {
 public:
  Cutter(SurfaceMesh mesh, const CutOptions& options, const MeshLimits& limits,
         const CancelToken& cancel)
      : options_(options), limits_(limits), cancel_(cancel), vertices_(mesh.vertices.size()) {
    result_.mesh = std::move(mesh);
  }

  Result<CutSurface> Run() {
    using Step = Status (Cutter::*)();
    for (const Step step : {&Cutter::Mend, &Cutter::CheckTriangles, &Cutter::CheckEdges,
                            &Cutter::CheckVertices, &Cutter::CheckAreas, &Cutter::Orient,
                            &Cutter::Part, &Cutter::CheckPieces, &Cutter::Finish}) {
      CHECK_OK(cancel_.Check());
      auto done = (this->*step)();
      if (!done) return Fail(Explained(std::move(done.error())));
    }
    return std::move(result_);
  }

 private:
  const std::vector<Triangle>& triangles() const { return result_.mesh.triangles; }

  // What is not as surfaces have to be may come of what a repair would mend.
  Fault Explained(Fault fault) const {
    fault = result_.repair.OfGiven(std::move(fault));
    switch (fault.kind) {
      case FaultKind::kNonManifoldEdge:
      case FaultKind::kNonManifoldVertex:
      case FaultKind::kNotOrientable:
      case FaultKind::kNotADisk:
        return WithDefects(std::move(fault), result_.warnings);
      default:
        return fault;
    }
  }

  Status Mend() {
    CHECK_OK(CheckArrays(result_.mesh, limits_));
    TRY(result_.repair, RepairTriangles(result_.mesh.vertices, result_.mesh.triangles,
                                        options_.repair, limits_, cancel_, &sides_));
    result_.warnings = std::move(result_.repair.warnings);
    repair_warnings_ = result_.warnings.size();
    return {};
  }

  Status CheckTriangles() { return CheckDuplicates(triangles(), sides_); }

  // Joins all edges of two triangles but the seams.
  Status CheckEdges() {
    TRY(auto seams, FindSeams(result_.repair.OfMended(options_.seams), sides_));
    gluing_ = GlueAll(sides_);
    for (const auto edge : seams.edges) {
      for (const Side& side : edge) gluing_.cut[side.index] = true;
    }
    std::vector<std::uint32_t> crowded;  // triangles on edges of three and more
    Status status;
    ForEachEdge(sides_, [&](std::span<const Side> edge) {
      if (edge.size() < 3 || gluing_.cut[edge[0].index] || !status) return;
      if (!options_.split_non_manifold) {
        status = Fail(Advised(NonManifoldEdgeFault(edge),
                              "make it a seam, or split_non_manifold cuts all such edges apart"));
      }
      for (const Side& side : edge) crowded.push_back(side.triangle());
      ++split_edges_;
    });
    if (!status) return status;
    std::sort(crowded.begin(), crowded.end());
    crowded.erase(std::unique(crowded.begin(), crowded.end()), crowded.end());
    AddWarning("split_edges", crowded,
               fmt::format("{} edges with three or more triangles were cut apart; they had {} "
                           "triangles",
                           split_edges_, crowded.size()),
               result_.warnings);
    AddWarning("boundary_seams", seams.on_boundary,
               fmt::format("{} seams lie on the boundary already", seams.on_boundary.size()),
               result_.warnings);
    seams_ = std::move(seams.edges);
    return {};
  }

  Status CheckVertices() {
    const auto touching = TouchingVertices(vertices_, triangles(), sides_, gluing_);
    whole_ = seams_.empty() && split_edges_ == 0 && touching.empty();
    if (touching.empty()) return {};
    if (options_.split_non_manifold) {
      AddWarning("split_vertices", touching,
                 fmt::format("{} vertices joined parts that touch in nothing else; each part has "
                             "its own now",
                             touching.size()),
                 result_.warnings);
      return {};
    }
    return Fail(Fault(FaultKind::kNonManifoldVertex,
                      fmt::format("Parts of the surface touch in vertex {} only ({} such vertices "
                                  "in all); split_non_manifold gives each part its own.",
                                  touching.front(), touching.size()))
                    .Field("mesh.triangles")
                    .Elements(touching)
                    .Detail("count", touching.size()));
  }

  Status CheckAreas() {
    result_.degenerate = DegenerateTriangles(result_.mesh);
    if (result_.degenerate.empty()) return {};
    if (!options_.tolerate_degenerate ||
        !std::isfinite(DiagonalOf(result_.mesh.vertices, triangles()))) {
      return Fail(Advised(DegenerateFault(result_.degenerate),
                          "tolerate_degenerate lets them through where the rest has area"));
    }
    AddWarning("degenerate_triangles", result_.degenerate,
               fmt::format("{} triangles have no area", result_.degenerate.size()),
               result_.warnings);
    return {};
  }

  Status Orient() {
    auto turned = TrianglesToTurn(triangles(), gluing_);
    if (!turned && turned.error().kind == FaultKind::kNotOrientable) {
      if (!options_.auto_cut) {
        return Fail(Advised(std::move(turned.error()), "give seams or set auto_cut"));
      }
      CutOpenOneSided();
      whole_ = false;
      turned = TrianglesToTurn(triangles(), gluing_);
    }
    if (!turned) return Fail(std::move(turned.error()));
    Turn(*std::move(turned));
    return {};
  }

  void CutOpenOneSided() {
    std::vector<std::uint32_t> ends;
    for (const std::uint32_t side : CutOneSided(triangles(), gluing_)) {
      const auto [low, high] =
          std::minmax({SideStart(triangles(), side), SideEnd(triangles(), side)});
      one_sided_.push_back({low, high});
      ends.push_back(low);
    }
    AddWarning("one_sided", ends,
               fmt::format("the surface has one side only and was cut open along {} edges",
                           one_sided_.size()),
               result_.warnings);
  }

  void Turn(std::vector<bool> turned) {
    if (std::find(turned.begin(), turned.end(), true) != turned.end()) {
      TurnTriangles(turned, result_.mesh.triangles, gluing_);
      // The seams' sides are numbered anew as well.
      TurnSides(turned, sides_);
      WarnTurned(turned, result_.warnings);
    }
    result_.turned = std::move(turned);
  }

  // Doubles the vertices along what was cut; seams that part nothing become warnings.
  Status Part() {
    if (whole_) {
      split_.triangles = triangles();
      split_.source.resize(vertices_);
      std::iota(split_.source.begin(), split_.source.end(), 0u);
      return {};
    }
    split_ = Split(vertices_, triangles(), gluing_);
    std::vector<std::uint32_t> ineffective;
    for (const std::uint32_t side : JoinUnparted(split_, sides_, gluing_)) {
      ineffective.push_back(std::min(SideStart(triangles(), side), SideEnd(triangles(), side)));
    }
    AddWarning("ineffective_seams", ineffective,
               fmt::format("{} seams are single edges inside the surface: cutting them parts "
                           "nothing",
                           ineffective.size()),
               result_.warnings);
    for (const auto edge : seams_) {
      const auto open = [this](const Side& side) { return gluing_.open(side.index); };
      if (std::any_of(edge.begin(), edge.end(), open)) {
        result_.cuts.push_back({edge[0].v0, edge[0].v1});
      }
    }
    seams_ = {};
    return {};
  }

  Status CheckPieces() {
    const auto pieces = FindPieces(split_.source.size(), split_.triangles, gluing_);
    CHECK_OK(CheckPieceAreas(pieces));
    // Automatic cuts leave every part in one.
    result_.charts = pieces.size();
    result_.chart_of.resize(triangles().size());
    for (std::uint32_t p = 0; p < pieces.size(); ++p) {
      for (const std::uint32_t t : pieces[p].triangles) result_.chart_of[t] = p;
    }
    if (!options_.auto_cut) return CheckPlanar(pieces);
    result_.cuts.insert(result_.cuts.end(), one_sided_.begin(), one_sided_.end());
    result_.auto_cuts = one_sided_.size();
    if (std::all_of(pieces.begin(), pieces.end(), [](const Piece& c) { return c.disk(); })) {
      return {};
    }
    TRY(const auto cut, CutToDisks(result_.mesh.vertices, split_, pieces, gluing_, cancel_));
    for (const std::uint32_t side : cut) {
      const auto [low, high] =
          std::minmax({SideStart(triangles(), side), SideEnd(triangles(), side)});
      result_.cuts.push_back({low, high});
    }
    result_.auto_cuts += cut.size();
    split_ = Split(vertices_, triangles(), gluing_);
    for (const Piece& piece : FindPieces(split_.source.size(), split_.triangles, gluing_)) {
      if (piece.disk()) continue;
      return Fail(FaultKind::kInternal,
                  fmt::format("An automatic cut left a piece that is {}.", piece.Describe()));
    }
    return {};
  }

  Status CheckPieceAreas(const std::vector<Piece>& pieces) const {
    if (result_.degenerate.empty()) return {};
    std::vector<bool> flat(triangles().size(), false);
    for (const std::uint32_t t : result_.degenerate) flat[t] = true;
    for (const Piece& piece : pieces) {
      const auto& all = piece.triangles;
      if (std::all_of(all.begin(), all.end(), [&](std::uint32_t t) { return flat[t]; })) {
        return Fail(Advised(DegenerateFault(all), "nothing in its component has area"));
      }
    }
    return {};
  }

  Status CheckPlanar(const std::vector<Piece>& pieces) const {
    Fault fault = Fault(FaultKind::kNotADisk, "").Field("mesh.triangles");
    const Piece* first = nullptr;
    std::size_t count = 0;
    for (const Piece& piece : pieces) {
      if (piece.planar()) continue;
      if (first == nullptr) first = &piece;
      fault.Element(piece.triangles.front());
      ++count;
    }
    if (first == nullptr) return {};
    fault.message = fmt::format(
        "The part of the surface with triangle {} is {}: it cannot be laid flat without a cut ({} "
        "such parts of {}); give seams or set auto_cut.",
        first->triangles.front(), first->Describe(), count, pieces.size());
    fault.Detail("components", pieces.size())
        .Detail("boundary_loops", first->boundary_starts.size())
        .Detail("genus", first->genus)
        .Detail("euler_characteristic", first->euler);
    return Fail(std::move(fault));
  }

  Status Finish() {
    const Repair& repair = result_.repair;
    for (std::size_t i = repair_warnings_; i < result_.warnings.size(); ++i) {
      result_.warnings[i] = repair.OfGiven(std::move(result_.warnings[i]));
    }
    // Vertices that others stand for are used too.
    WarnUnreferenced(vertices_, repair.changed() ? repair.given : triangles(), result_.warnings);
    gluing_ = {};
    result_.mesh.triangles = std::move(split_.triangles);
    result_.source = std::move(split_.source);
    result_.mesh.vertices.reserve(result_.source.size());
    for (std::size_t v = vertices_; v < result_.source.size(); ++v) {
      result_.mesh.vertices.push_back(result_.mesh.vertices[result_.source[v]]);
    }
    if (result_.source.size() > vertices_) {
      sides_ = SortedSides(result_.source.size(), result_.mesh.triangles);
    }
    result_.sides = std::move(sides_);
    return {};
  }

  const CutOptions& options_;
  const MeshLimits& limits_;
  const CancelToken& cancel_;
  std::size_t vertices_;  // of the input
  std::size_t repair_warnings_ = 0;
  std::vector<Side> sides_;  // of the triangles as they came, turned
  std::vector<std::span<const Side>> seams_;
  std::size_t split_edges_ = 0;
  bool whole_ = false;  // nothing is cut or comes apart: every vertex has one fan
  std::vector<std::array<std::uint32_t, 2>>
      one_sided_;  // edges cut because nothing else orients them
  Gluing gluing_;
  SplitVertices split_;
  CutSurface result_;
};

}  // namespace

Result<CutSurface> CutToCharts(SurfaceMesh mesh, const CutOptions& options,
                               const MeshLimits& limits, const CancelToken& cancel) {
  return Cutter(std::move(mesh), options, limits, cancel).Run();
}

}  // namespace arap
