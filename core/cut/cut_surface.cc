#include "core/cut/cut_surface.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/cut/auto_cut.h"
#include "core/cut/chart.h"
#include "core/cut/corners.h"
#include "core/cut/seams.h"
#include "core/mesh/gluing.h"
#include "core/mesh/space.h"

namespace arap {
namespace {

Fault Advised(Fault fault, const char* advice) {
  fault.message += "; ";
  fault.message += advice;
  return fault;
}

// The surface on its way: the input triangles, turned as far as known, and what joins them.
class Cutter {
 public:
  Cutter(SurfaceMesh mesh, const CutOptions& options, const MeshLimits& limits,
         const CancelToken& cancel)
      : options_(options), limits_(limits), cancel_(cancel), vertices_(mesh.vertices.size()) {
    result_.mesh = std::move(mesh);
  }

  Result<CutSurface> Run() {
    using Step = Status (Cutter::*)();
    for (const Step step :
         {&Cutter::TakeSides, &Cutter::CheckEdges, &Cutter::CheckVertices, &Cutter::CheckAreas,
          &Cutter::Orient, &Cutter::Part, &Cutter::CheckCharts, &Cutter::Finish}) {
      if (auto ok = cancel_.Check(); !ok) return Fail(std::move(ok.error()));
      if (auto ok = (this->*step)(); !ok) return Fail(std::move(ok.error()));
    }
    return std::move(result_);
  }

 private:
  const std::vector<Triangle>& triangles() const { return result_.mesh.triangles; }

  Status TakeSides() {
    if (auto ok = CheckArrays(result_.mesh, limits_); !ok) return ok;
    sides_ = SortedSides(vertices_, triangles());
    return CheckDuplicates(triangles(), sides_);
  }

  // Joins all edges of two triangles but the seams.
  Status CheckEdges() {
    auto seams = FindSeams(options_.seams, sides_);
    if (!seams) return Fail(std::move(seams.error()));
    gluing_ = GlueAll(sides_);
    for (const auto edge : seams->edges) {
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
    AddWarning("boundary_seams", seams->on_boundary,
               fmt::format("{} seams lie on the boundary already", seams->on_boundary.size()),
               result_.warnings);
    seams_ = std::move(seams->edges);
    return {};
  }

  Status CheckVertices() {
    const auto touching = TouchingVertices(vertices_, triangles(), sides_);
    if (touching.empty()) return {};
    if (options_.split_non_manifold) {
      AddWarning("split_vertices", touching,
                 fmt::format("{} vertices joined parts that touch in nothing else; each part has "
                             "its own now",
                             touching.size()),
                 result_.warnings);
      return {};
    }
    Fault fault =
        Fault(FaultKind::kNonManifoldVertex,
              fmt::format("parts of the surface touch in vertex {} only ({} such vertices in "
                          "all); split_non_manifold gives each part its own",
                          touching.front(), touching.size()))
            .Field("mesh.triangles");
    for (const std::uint32_t v : touching) fault.Element(v);
    fault.Detail("count", fmt::to_string(touching.size()));
    return Fail(std::move(fault));
  }

  Status CheckAreas() {
    result_.degenerate = DegenerateTriangles(result_.mesh);
    if (result_.degenerate.empty()) return {};
    if (!options_.tolerate_degenerate || !std::isfinite(Diagonal())) {
      return Fail(Advised(DegenerateFault(result_.degenerate),
                          "tolerate_degenerate lets them through where the rest has area"));
    }
    AddWarning("degenerate_triangles", result_.degenerate,
               fmt::format("{} triangles have no area", result_.degenerate.size()),
               result_.warnings);
    return {};
  }

  double Diagonal() const {
    Eigen::AlignedBox3d box;
    for (const Triangle& t : triangles()) {
      for (const std::uint32_t v : t) box.extend(Vec(result_.mesh.vertices[v]));
    }
    return box.diagonal().norm();
  }

  Status Orient() {
    auto turned = TrianglesToTurn(triangles(), gluing_);
    if (!turned) return Fail(std::move(turned.error()));
    TurnTriangles(*turned, result_.mesh.triangles, gluing_);
    // The seams' sides are numbered anew as well.
    for (Side& side : sides_) {
      if ((*turned)[side.triangle()] && side.corner() != 0) {
        side.index = 3 * side.triangle() + 3 - side.corner();
      }
    }
    WarnTurned(*turned, result_.warnings);
    result_.turned = std::move(*turned);
    return {};
  }

  // Doubles the vertices, and forgets the seams that part nothing.
  Status Part() {
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
    sides_ = {};
    return {};
  }

  Status CheckCharts() {
    const auto charts = FindCharts(split_.source.size(), split_.triangles, gluing_);
    if (auto ok = CheckChartAreas(charts); !ok) return ok;
    if (!options_.auto_cut) return CheckPlanar(charts);
    if (std::all_of(charts.begin(), charts.end(), [](const Chart& c) { return c.disk(); })) {
      return {};
    }
    const auto cut = CutToDisks(result_.mesh.vertices, split_, charts, gluing_, cancel_);
    if (!cut) return Fail(cut.error());
    for (const std::uint32_t side : *cut) {
      const auto [low, high] =
          std::minmax({SideStart(triangles(), side), SideEnd(triangles(), side)});
      result_.cuts.push_back({low, high});
    }
    result_.auto_cuts = cut->size();
    split_ = Split(vertices_, triangles(), gluing_);
    for (const Chart& chart : FindCharts(split_.source.size(), split_.triangles, gluing_)) {
      if (chart.disk()) continue;
      return Fail(FaultKind::kInternal, "an automatic cut left a chart " + chart.Describe());
    }
    return {};
  }

  Status CheckChartAreas(const std::vector<Chart>& charts) const {
    if (result_.degenerate.empty()) return {};
    std::vector<bool> flat(triangles().size(), false);
    for (const std::uint32_t t : result_.degenerate) flat[t] = true;
    for (const Chart& chart : charts) {
      const auto& all = chart.triangles;
      if (std::all_of(all.begin(), all.end(), [&](std::uint32_t t) { return flat[t]; })) {
        return Fail(Advised(DegenerateFault(all), "nothing in its component has area"));
      }
    }
    return {};
  }

  Status CheckPlanar(const std::vector<Chart>& charts) const {
    Fault fault = Fault(FaultKind::kNotADisk, "").Field("mesh.triangles");
    const Chart* first = nullptr;
    std::size_t count = 0;
    for (const Chart& chart : charts) {
      if (chart.planar()) continue;
      if (first == nullptr) first = &chart;
      fault.Element(chart.triangles.front());
      ++count;
    }
    if (first == nullptr) return {};
    fault.message = fmt::format(
        "the part of the surface with triangle {} is {}: it cannot be laid flat without a cut ({} "
        "such parts of {}); give seams or set auto_cut",
        first->triangles.front(), first->Describe(), count, charts.size());
    fault.Detail("components", fmt::to_string(charts.size()))
        .Detail("boundary_loops", fmt::to_string(first->boundary_starts.size()))
        .Detail("genus", fmt::to_string(first->genus))
        .Detail("euler_characteristic", fmt::to_string(first->euler));
    return Fail(std::move(fault));
  }

  Status Finish() {
    WarnUnreferenced(vertices_, triangles(), result_.warnings);
    gluing_ = {};
    result_.mesh.triangles = std::move(split_.triangles);
    result_.source = std::move(split_.source);
    result_.mesh.vertices.reserve(result_.source.size());
    for (std::size_t v = vertices_; v < result_.source.size(); ++v) {
      result_.mesh.vertices.push_back(result_.mesh.vertices[result_.source[v]]);
    }
    result_.topology = BuildTopology(result_.mesh.vertices.size(), result_.mesh.triangles);
    return {};
  }

  const CutOptions& options_;
  const MeshLimits& limits_;
  const CancelToken& cancel_;
  std::size_t vertices_;     // of the input
  std::vector<Side> sides_;  // until the vertices are split
  std::vector<std::span<const Side>> seams_;
  std::size_t split_edges_ = 0;
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
