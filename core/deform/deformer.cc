#include "core/deform/deformer.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/deform/compiled_parts.h"
#include "core/energy/local_step.h"

namespace arap {
namespace {

bool IsFinite(const Target& t) {
  return std::isfinite(t.position.real()) && std::isfinite(t.position.imag()) &&
         std::isfinite(t.angle) && std::isfinite(t.scale);
}

// Where the target puts a point that lies `offset` from the handle at rest.
Complex OffsetAt(const Target& target, Complex offset) {
  if (offset == 0.0) return 0;
  return target.scale * Complex(std::cos(target.angle), std::sin(target.angle)) * offset;
}

}  // namespace

// p ↦ place + turn·(p − from)
struct Similarity {
  Complex from, place;
  Complex turn = 1;
};

// All that a frame needs. Coordinates are normalised and relative to the mean target, which both
// steps commute with; that keeps far targets exact.
class Deformer::Scratch {
 public:
  explicit Scratch(std::shared_ptr<const CompiledHandles> compiled)
      : handles(std::move(compiled)), set(handles->parts()), mesh(set.mesh->parts()) {
    const std::size_t n = mesh.rest.size();
    const std::size_t components = mesh.components.size();
    positions.assign(mesh.mesh.vertices.begin(), mesh.mesh.vertices.end());
    next.resize(n);
    shape.resize(2 * n);
    targets.resize(set.rows.size());
    miss.resize(set.active_rows.size());
    mean.assign(components, 1);
    shift.assign(components, 0);
    base.assign(components, {});
    counts.assign(components, 0);
    sizes.assign(components, 0);
    set.solver->Prepare(solver);
  }

  Result<ShapeQuality> Update(std::span<const Target> given, const DeformOptions& options);

 private:
  std::size_t n() const { return mesh.rest.size(); }
  double* x() { return shape.data(); }
  double* y() { return shape.data() + n(); }
  ConstShapeView View() const { return {shape.data(), shape.data() + n()}; }

  Status Check(std::span<const Target> given, const DeformOptions& options) const;
  void PlaceTargets(std::span<const Target> given);
  Status CheckDependent() const;
  void PlaceTranslating();
  void FitBase();
  void StartFromBase(bool rigid);
  Status SimilarityStep();
  Status RigidStep(bool turn_cells);
  bool Finish();
  ShapeQuality Measure(std::span<const Target> given) const;

 public:
  std::shared_ptr<const CompiledHandles> handles;
  std::vector<Complex> positions;  // #V, of the last good frame

 private:
  const CompiledHandlesParts& set;
  const RegisteredMeshParts& mesh;
  std::vector<Complex> next;          // #V, of this frame until it is known to be finite
  std::vector<double> shape;          // #V×2, x then y, of this frame
  std::vector<Complex> targets;       // per row
  std::vector<Complex> miss;          // per active row: target minus place
  std::vector<Similarity> base;       // per component: the similarity that fits its targets best
  std::vector<double> counts, sizes;  // per component, of FitBase
  std::vector<Complex> mean;          // per component: t̄, the rotation of `base`
  std::vector<Complex> shift;         // per component: how far a translating one moves
  Complex middle;                     // mean target
  SolverScratch solver;
};

Status Deformer::Scratch::Check(std::span<const Target> given, const DeformOptions& options) const {
  if (options.refine < 0 || options.refine > kMaxRefine) {
    return Fail(Fault{FaultKind::kInvalidOption,
                      fmt::format("refine is {}; it must be 0 to {}", options.refine, kMaxRefine),
                      {},
                      {{"limit", fmt::to_string(kMaxRefine)}},
                      "options.refine"});
  }
  if (given.size() != set.handles.size()) {
    Fault fault{FaultKind::kTargetCount,
                fmt::format("{} targets for {} handles", given.size(), set.handles.size()),
                {},
                {},
                "targets"};
    fault.Detail("count", fmt::to_string(given.size()))
        .Detail("expected", fmt::to_string(set.handles.size()));
    return Fail(std::move(fault));
  }
  for (std::size_t h = 0; h < given.size(); ++h) {
    const std::string& id = set.handles[h].handle.id;
    if (!IsFinite(given[h])) {
      return Fail(Fault{FaultKind::kNonFiniteTarget,
                        fmt::format("the target of handle \"{}\" is NaN or infinite", id),
                        {static_cast<std::uint32_t>(h)},
                        {{"handle", id}},
                        "targets"});
    }
    if (given[h].scale < 0) {
      return Fail(Fault{FaultKind::kInvalidOption,
                        fmt::format("the scale of handle \"{}\" is {}; it must be at least 0", id,
                                    given[h].scale),
                        {static_cast<std::uint32_t>(h)},
                        {{"handle", id}},
                        "targets"});
    }
  }
  return {};
}

void Deformer::Scratch::PlaceTargets(std::span<const Target> given) {
  for (std::size_t r = 0; r < set.rows.size(); ++r) {
    const Row& row = set.rows[r];
    const Target& target = given[row.handle];
    targets[r] = mesh.Normalise(target.position);
    targets[r] += OffsetAt(target, row.offset);
  }
  middle = 0;
  for (const std::size_t r : set.active_rows) middle += targets[r];
  if (!set.active_rows.empty()) middle /= static_cast<double>(set.active_rows.size());
  for (Complex& c : targets) c -= middle;
}

Status Deformer::Scratch::CheckDependent() const {
  for (const DependentRow& dependent : set.dependent) {
    Complex expected = 0;
    double size = std::abs(targets[dependent.row]) + 1;
    for (const auto& [row, coefficient] : dependent.combination) {
      expected += coefficient * targets[row];
      size += std::abs(coefficient * targets[row]);
    }
    const double gap = std::abs(expected - targets[dependent.row]);
    if (gap <= kCoincident * size) continue;
    const std::uint32_t h = set.rows[dependent.row].handle;
    Fault fault{FaultKind::kConflictingHandles, "", {h}, {}, "targets"};
    std::string others;
    for (const auto& [row, coefficient] : dependent.combination) {
      const std::uint32_t other = set.rows[row].handle;
      fault.Element(other);
      others += fmt::format("{}\"{}\"", others.empty() ? "" : ", ", set.handles[other].handle.id);
    }
    fault.message = fmt::format(
        "hard handle \"{}\" cannot meet its target: {} decide its place, which is {} away; make "
        "one "
        "of them soft",
        set.handles[h].handle.id, others, gap * mesh.report.diagonal);
    fault.Detail("distance", fmt::to_string(gap * mesh.report.diagonal));
    return Fail(std::move(fault));
  }
  return {};
}

// A component with one distinct point follows it: soft handles average by weight, hard ones decide.
void Deformer::Scratch::PlaceTranslating() {
  for (std::size_t c = 0; c < shift.size(); ++c) {
    shift[c] = 0;
    if (set.roles[c] != ComponentRole::kTranslating) continue;
    double weights = 0;
    bool hard = false;
    for (std::size_t r = 0; r < set.rows.size(); ++r) {
      const Row& row = set.rows[r];
      if (row.component != c || (hard && row.compliance > 0)) continue;
      if (row.compliance == 0 && !hard) {
        hard = true;
        shift[c] = weights = 0;
      }
      const double weight = hard ? 1 : 1 / row.compliance;
      shift[c] += weight * (targets[r] + middle - row.rest);
      weights += weight;
    }
    shift[c] /= weights;
  }
}

// The similarity of each component that fits its targets best. It is in the null space of step 1,
// and its rotation in that of the turned edges of step 2; solving for the difference keeps rigid
// motions exact.
void Deformer::Scratch::FitBase() {
  for (Similarity& s : base) s = {0, 0, 0};
  for (std::size_t c = 0; c < base.size(); ++c) counts[c] = sizes[c] = 0;
  for (const std::size_t r : set.active_rows) {
    const std::uint32_t c = set.rows[r].component;
    base[c].from += set.rows[r].rest;
    base[c].place += targets[r];
    counts[c] += 1;
  }
  for (std::size_t c = 0; c < base.size(); ++c) {
    if (counts[c] == 0) continue;
    base[c].from /= counts[c];
    base[c].place /= counts[c];
  }
  for (const std::size_t r : set.active_rows) {
    const std::uint32_t c = set.rows[r].component;
    const Complex arm = set.rows[r].rest - base[c].from;
    base[c].turn += std::conj(arm) * (targets[r] - base[c].place);
    sizes[c] += std::norm(arm);
  }
  for (std::size_t c = 0; c < base.size(); ++c) {
    if (counts[c] > 0) base[c].turn /= sizes[c];
    const double size = std::abs(base[c].turn);
    mean[c] = size > kNoDirection ? base[c].turn / size : 1;
  }
}

// shape := the base, or its rigid part; miss := what the rows lack.
void Deformer::Scratch::StartFromBase(bool rigid) {
  for (std::size_t v = 0; v < n(); ++v) {
    const std::uint32_t c = mesh.topology.vertex_component[v];
    Complex p = mesh.rest[v];
    if (c != kNone && set.active_slot[c] != kNone) {
      p = base[c].place + (rigid ? mean[c] : base[c].turn) * (p - base[c].from);
    }
    x()[v] = p.real();
    y()[v] = p.imag();
  }
  for (std::size_t i = 0; i < miss.size(); ++i) {
    const std::size_t r = set.active_rows[i];
    miss[i] = targets[r] - PointOf(set.rows[r], View());
  }
}

// Step 1: as similar as possible.
Status Deformer::Scratch::SimilarityStep() {
  StartFromBase(false);
  if (!set.solver->AddSimilarity(miss, {x(), y()}, solver)) {
    return Fail(FaultKind::kNumerical, "a back-substitution ran out of memory");
  }
  return {};
}

// Step 2, with the rotations of `shape`. Without turning the cells it is the baseline of eq. 1,
// where every rotation is 1 and the force vanishes.
Status Deformer::Scratch::RigidStep(bool turn_cells) {
  if (turn_cells) {
    std::fill(solver.force.begin(), solver.force.end(), 0.0);
    AddRotatedEdges(mesh.cells, View(), mean, mesh.topology.vertex_component,
                    {solver.force.data(), solver.force.data() + n()});
  } else {
    std::fill(mean.begin(), mean.end(), Complex(1));
  }
  StartFromBase(true);
  if (!set.solver->AddRigid(turn_cells, miss, {x(), y()}, solver)) {
    return Fail(FaultKind::kNumerical, "a back-substitution ran out of memory");
  }
  return {};
}

// Back to the units of the mesh, into `next`. False when a number is not finite.
bool Deformer::Scratch::Finish() {
  const double unit = mesh.report.diagonal;
  double probe = 0;  // NaN or infinite as soon as one number is
  for (std::size_t v = 0; v < n(); ++v) {
    const std::uint32_t c = mesh.topology.vertex_component[v];
    if (c != kNone && set.active_slot[c] != kNone) {
      next[v] = mesh.origin + unit * (Complex(x()[v], y()[v]) + middle);
    } else {
      next[v] = mesh.mesh.vertices[v];
      if (c != kNone) next[v] += unit * shift[c];
    }
    probe += 0 * next[v].real() + 0 * next[v].imag();
  }
  return probe == 0;
}

ShapeQuality Deformer::Scratch::Measure(std::span<const Target> given) const {
  ShapeQuality quality;
  const auto stretch = mesh.stretch.Measure(mesh.mesh, next, mesh.report.diagonal);
  quality.flipped = stretch.flipped;
  quality.mean_stretch = stretch.mean;
  quality.max_stretch = stretch.max;
  quality.energy = RigidEnergy(mesh.cells, View());
  for (const Row& row : set.rows) {
    Complex p = 0;
    for (std::size_t k = 0; k < 3; ++k) p += row.weight[k] * next[row.vertex[k]];
    const Target& target = given[row.handle];
    const Complex wanted = target.position + OffsetAt(target, row.offset) * mesh.report.diagonal;
    const double error = std::abs(p - wanted);
    if (error > quality.worst_handle_error) {
      quality.worst_handle_error = error;
      quality.worst_handle = row.handle;
    }
  }
  return quality;
}

Result<ShapeQuality> Deformer::Scratch::Update(std::span<const Target> given,
                                               const DeformOptions& options) {
  if (auto ok = Check(given, options); !ok) return Fail(std::move(ok.error()));
  PlaceTargets(given);
  if (auto ok = CheckDependent(); !ok) return Fail(std::move(ok.error()));
  PlaceTranslating();
  FitBase();
  if (auto ok = SimilarityStep(); !ok) return Fail(std::move(ok.error()));
  if (options.mode != DeformMode::kSimilarity) {
    const bool rigid = options.mode == DeformMode::kRigid;
    for (int i = 0; i <= (rigid ? options.refine : 0); ++i) {
      if (auto ok = RigidStep(rigid); !ok) return Fail(std::move(ok.error()));
    }
  }
  if (!Finish()) {
    return Fail(FaultKind::kNumerical,
                "the shape is not finite: the targets are too far away for this mesh");
  }
  const ShapeQuality quality = Measure(given);
  if (!std::isfinite(quality.energy) || !std::isfinite(quality.worst_handle_error) ||
      !std::isfinite(quality.mean_stretch)) {
    return Fail(FaultKind::kNumerical, "a measure of the shape is not finite");
  }
  positions.swap(next);
  return quality;
}

Deformer::Deformer(std::shared_ptr<const CompiledHandles> handles)
    : scratch_(std::make_unique<Scratch>(std::move(handles))) {}
Deformer::~Deformer() = default;
Deformer::Deformer(Deformer&&) noexcept = default;
Deformer& Deformer::operator=(Deformer&&) noexcept = default;

Result<ShapeQuality> Deformer::Update(std::span<const Target> targets,
                                      const DeformOptions& options) {
  return scratch_->Update(targets, options);
}

std::span<const Complex> Deformer::positions() const { return scratch_->positions; }

std::vector<std::uint32_t> Deformer::FlippedTriangles() const {
  std::vector<std::uint32_t> flipped;
  const auto& triangles = scratch_->handles->mesh()->mesh().triangles;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    if (IsFlipped(triangles[t], scratch_->positions)) flipped.push_back(t);
  }
  return flipped;
}

const std::shared_ptr<const CompiledHandles>& Deformer::handles() const {
  return scratch_->handles;
}

}  // namespace arap
