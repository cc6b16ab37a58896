// Registrations, compilations, edits, frames and picks beside their estimates.
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "arap/core/cost.h"
#include "arap/core/deformer.h"
#include "arap/core/pick.h"
#include "tests/bench/contenders.h"
#include "tests/bench/estimated_cell.h"
#include "tests/bench/estimates_section.h"
#include "tests/support/meshes.h"

namespace arap::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kBudget = 600;  // seconds for a row
constexpr std::size_t kPickedPoints = 1024;
constexpr std::size_t kMillion = 1'000'000;  // vertices: registered, and no more

struct MeshRow {
  std::string name;
  std::size_t side;  // vertices along it
  Basis basis;
};

// On points of triangles all over the mesh.
std::vector<Handle> ScatteredHandles(const PlanarMesh& mesh, std::size_t count, bool hard) {
  std::vector<Handle> handles(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double part = std::fmod(static_cast<double>(i + 1) / std::numbers::phi, 1.0);
    const auto triangle =
        static_cast<std::uint32_t>(part * static_cast<double>(mesh.triangles.size()));
    handles[i].id = fmt::format("h{}", i);
    handles[i].anchor = TriangleAnchor{triangle, {0.5, 0.3, 0.2}};
    handles[i].hard = hard;
  }
  return handles;
}

// One handle that holds a fifth of a square in its middle.
std::vector<Handle> AreaHandle(std::size_t side, bool hard) {
  Handle handle;
  handle.id = "area";
  handle.anchor = VertexAnchor{static_cast<std::uint32_t>((side / 2) * side + side / 2)};
  handle.area_radius = static_cast<double>(side) * std::sqrt(0.2 / std::numbers::pi);
  handle.hard = hard;
  return {handle};
}

// Two poses that handles go between.
std::array<std::vector<Target>, 2> PosesOf(const CompiledHandles& handles, double reach) {
  std::array<std::vector<Target>, 2> poses{handles.RestTargets(), handles.RestTargets()};
  for (std::size_t pose = 0; pose < poses.size(); ++pose) {
    for (std::size_t i = 0; i < poses[pose].size(); ++i) {
      poses[pose][i].position += std::polar(reach, static_cast<double>(pose + 2 * i));
    }
  }
  return poses;
}

// Frames as they come in a stream, and what the Deformer holds for them. With picks the memory is
// that of finding them.
Json FrameCell(const HandlesPointer& handles, const DeformOptions& options, std::size_t picks = 0) {
  const PlanarMesh& mesh = handles->mesh()->mesh();
  const auto poses = PosesOf(*handles, 0.02 * std::sqrt(static_cast<double>(mesh.vertices.size())));
  const Cost cost = EstimateFrame(*handles, options, picks);
  std::optional<Deformer> deformer;
  const PeakMemory held;
  deformer.emplace(handles);
  Must(deformer->Update(poses[0], options));
  std::size_t growth = held.Growth();
  std::vector<Complex> points;
  for (std::size_t i = 0; i < picks; ++i) {
    points.push_back(deformer->positions()[i * mesh.vertices.size() / picks]);
  }
  if (picks > 0) {
    const PeakMemory found;
    Must(FindPicks(*handles, deformer->positions(), points));
    growth = found.Growth();
  }
  Samples samples;
  std::size_t pose = 0;
  Repeat(3, 0.15, 200, [&] {
    pose = 1 - pose;
    samples.Time([&] {
      Must(deformer->Update(poses[pose], options));
      if (picks > 0) Must(FindPicks(*handles, deformer->positions(), points));
    });
  });
  return {{"estimated_ms", cost.milliseconds},
          {"measured_ms", samples.Least() * 1e-3},
          {"estimated_bytes", picks > 0 ? cost.bytes : DeformerBytes(*handles)},
          {"measured_bytes", growth}};
}

const std::vector<std::string>& DeformColumns() {
  static const std::vector<std::string> kColumns{
      "register",   "8 handles",       "60",   "120",   "200 hard",
      "hard area",  "soft area",       "+1",   "frame", "refine 10",
      "frame, 120", "frame, 200 hard", "picks"};
  return kColumns;
}

Json DeformCells(const MeshRow& row) {
  const PlanarMesh square = testing::JitteredGrid(row.side - 1, row.side - 1, 1);
  const EnergyOptions energy{row.basis, Weights::kUniform, {}};
  const auto registration = [&] { return Must(RegisteredMesh::Register(square, energy)); };
  // What the libraries take once is taken.
  Must(RegisteredMesh::Register(testing::JitteredGrid(20, 20, 1), energy));
  Json cells = Json::object();
  const Cost registered = EstimateRegistration(square.vertices.size(), row.basis);
  const int rounds = square.vertices.size() < kMillion ? 2 : 1;
  cells["register"] = MeasureCell(registered.milliseconds, registered.bytes, registration, rounds);
  if (square.vertices.size() >= kMillion) return cells;

  const MeshPointer mesh = registration();
  const auto compile = [&](const char* column, const std::vector<Handle>& handles) {
    const Cost cost = EstimateCompilation(*mesh, Must(CountRows(*mesh, handles)));
    const auto work = [&] { return Must(CompiledHandles::Compile(mesh, handles)); };
    cells[column] = MeasureCell(cost.milliseconds, cost.bytes, work);
  };
  const auto eight = ScatteredHandles(square, 8, false);
  const auto many = ScatteredHandles(square, 120, false);
  const auto hard = ScatteredHandles(square, 200, true);
  compile("8 handles", eight);
  compile("60", ScatteredHandles(square, 60, false));
  compile("120", many);
  compile("200 hard", hard);
  compile("hard area", AreaHandle(row.side, true));
  compile("soft area", AreaHandle(row.side, false));

  HandlesPointer set = Must(CompiledHandles::Compile(mesh, eight));
  const std::vector<Handle> ninth{ScatteredHandles(square, 9, false).back()};
  const Cost edit = EstimateEdit(*set, {}, Must(CountRows(*mesh, ninth))).cost;
  cells["+1"] =
      MeasureCell(edit.milliseconds, edit.bytes, [&] { return Must(set->Edit({}, ninth)); });
  cells["frame"] = FrameCell(set, {});
  cells["refine 10"] = FrameCell(set, {DeformMode::kRigid, 10});
  cells["picks"] = FrameCell(set, {}, kPickedPoints);
  set = Must(CompiledHandles::Compile(mesh, many));
  cells["frame, 120"] = FrameCell(set, {});
  set = Must(CompiledHandles::Compile(mesh, hard));
  cells["frame, 200 hard"] = FrameCell(set, {});
  return cells;
}

}  // namespace

Json MeasureDeformEstimates(bool million) {
  const std::vector<MeshRow> grid{
      {"1k, EDGE", 32, Basis::kEdge},      {"10k, EDGE", 100, Basis::kEdge},
      {"62k, EDGE", 250, Basis::kEdge},    {"160k, EDGE", 400, Basis::kEdge},
      {"1k, FACE", 32, Basis::kFace},      {"10k, FACE", 100, Basis::kFace},
      {"62k, FACE", 250, Basis::kFace},    {"160k, FACE", 400, Basis::kFace},
      {"1k, VERTEX", 32, Basis::kVertex},  {"10k, VERTEX", 100, Basis::kVertex},
      {"62k, VERTEX", 250, Basis::kVertex}};
  const std::vector<MeshRow> large{{"1M, EDGE", 1000, Basis::kEdge},
                                   {"1M, FACE", 1000, Basis::kFace},
                                   {"1M, VERTEX", 1000, Basis::kVertex}};
  PrintEstimatesHead("vertices, cells", DeformColumns());
  Json all = Json::object();
  for (const MeshRow& row : million ? large : grid) {
    const auto cells = RunApart(kBudget, [&] { return DeformCells(row); });
    if (!cells) continue;
    all[row.name] = *cells;
    PrintEstimates(row.name, DeformColumns(), *cells);
  }
  return all;
}

}  // namespace arap::bench
