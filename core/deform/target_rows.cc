#include "core/deform/target_rows.h"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "arap/core/deformer.h"
#include "core/base/names.h"
#include "core/base/plane.h"
#include "core/base/try.h"

namespace arap {
namespace {

bool IsGood(const Target& t) {
  return IsFinite(t.position) && std::isfinite(t.angle) && t.scale >= 0 &&
         t.scale <= Target::kMaxScale;
}

}  // namespace

Status CheckTarget(const Target& t, std::string_view array, std::size_t index,
                   std::string_view handle_id) {
  if (IsGood(t)) return {};
  const auto bad = [&](FaultKind kind, const char* part, double value, const std::string& what) {
    const std::string field = fmt::format("{}[{}].{}", array, index, part);
    return Fault(kind, fmt::format("{} of handle {} is {}.", field, Quote(handle_id), what))
        .Field(field)
        .Detail("handle_id", std::string(handle_id))
        .Detail("value", value);
  };
  for (const auto& [part, value] :
       {std::pair("x", t.position.real()), std::pair("y", t.position.imag()),
        std::pair("angle_radians", t.angle), std::pair("scale", t.scale)}) {
    if (std::isfinite(value)) continue;
    return Fail(bad(FaultKind::kNonFiniteTarget, part, value, "not finite"));
  }
  return Fail(bad(FaultKind::kInvalidOption, "scale", t.scale,
                  fmt::format("{}, not between 0 and {}", t.scale, Target::kMaxScale))
                  .Detail("limit", Target::kMaxScale));
}

TargetRows::TargetRows(const CompiledHandlesParts& set)
    : set_(set),
      mesh_(set.mesh->parts()),
      targets_(set.rows.size()),
      turns_(set.handles.size()),
      shift_(mesh_.components.size()),
      weights_(mesh_.components.size()),
      hard_(mesh_.components.size()) {}

Status TargetRows::Place(std::span<const Target> given) {
  CHECK_OK(Check(given));
  PlaceRows(given);
  CHECK_OK(CheckFar());
  CHECK_OK(CheckDependent());
  PlaceTranslating();
  return {};
}

Status TargetRows::Check(std::span<const Target> given) const {
  if (given.size() != set_.handles.size()) {
    return Fail(Fault(FaultKind::kTargetCount, fmt::format("There are {} targets for {} handles.",
                                                           given.size(), set_.handles.size()))
                    .Field("targets")
                    .Detail("count", given.size())
                    .Detail("expected", set_.handles.size()));
  }
  for (std::size_t h = 0; h < given.size(); ++h) {
    if (auto good = CheckTarget(given[h], "targets", h, set_.handles[h].handle.id); !good) {
      return Fail(std::move(good.error().Element(static_cast<std::uint32_t>(h))));
    }
  }
  return {};
}

void TargetRows::PlaceRows(std::span<const Target> given) {
  for (std::size_t h = 0; h < given.size(); ++h) {
    const Handle& handle = set_.handles[h].handle;
    if (!handle.oriented && handle.area_radius == 0) continue;
    turns_[h] = given[h].scale * Complex(std::cos(given[h].angle), std::sin(given[h].angle));
  }
  for (std::size_t r = 0; r < set_.rows.size(); ++r) {
    const Row& row = set_.rows[r];
    targets_[r] = mesh_.Normalise(given[row.handle].position) + OffsetOf(row);
  }
  middle_ = 0;
  for (const std::size_t r : set_.roles.active_rows) middle_ += targets_[r];
  if (!set_.roles.active_rows.empty())
    middle_ /= static_cast<double>(set_.roles.active_rows.size());
  for (Complex& c : targets_) c -= middle_;
}

// Squares of what is farther away are no numbers: rotations would be 0 and positions nevertheless finite.
Status TargetRows::CheckFar() const {
  constexpr double kFarthest = 1e140;  // diagonals
  for (const Complex& target : targets_) {
    if (std::abs(target.real()) <= kFarthest && std::abs(target.imag()) <= kFarthest) continue;
    return Fail(FaultKind::kNumerical,
                "The shape is not finite: the targets are too far away for this mesh.");
  }
  return {};
}

Status TargetRows::CheckDependent() const {
  for (const DependentRow& dependent : set_.roles.dependent) {
    Complex expected = 0;
    double size = std::abs(targets_[dependent.row]) + 1;
    for (const auto& [row, coefficient] : dependent.combination) {
      expected += coefficient * targets_[row];
      size += std::abs(coefficient * targets_[row]);
    }
    const double gap = std::abs(expected - targets_[dependent.row]);
    if (gap <= kCoincident * size) continue;
    const std::uint32_t h = set_.rows[dependent.row].handle;
    Fault fault(FaultKind::kConflictingHandles, "");
    fault.Element(h);
    std::string others;
    for (const auto& [row, coefficient] : dependent.combination) {
      const std::uint32_t other = set_.rows[row].handle;
      fault.Element(other);
      others += fmt::format("{}\"{}\"", others.empty() ? "" : ", ", set_.handles[other].handle.id);
    }
    const double distance = gap * mesh_.report.diagonal;
    fault.message = fmt::format(
        "Hard handle \"{}\" cannot meet its target: {} decide its place, which is {} away; make "
        "one "
        "of them soft.",
        set_.handles[h].handle.id, others, distance);
    return Fail(std::move(fault).Field("targets").Detail("distance", distance));
  }
  return {};
}

// A component with one distinct point follows it: soft handles average by weight, hard ones decide.
void TargetRows::PlaceTranslating() {
  for (std::size_t c = 0; c < shift_.size(); ++c) {
    shift_[c] = weights_[c] = 0;
    hard_[c] = false;
  }
  for (std::size_t r = 0; r < set_.rows.size(); ++r) {
    const Row& row = set_.rows[r];
    const std::uint32_t c = row.component;
    if (set_.roles.of[c] != ComponentRole::kTranslating) continue;
    const bool hard = row.compliance == 0;
    if (hard_[c] && !hard) continue;
    if (hard && !hard_[c]) {
      hard_[c] = true;
      shift_[c] = weights_[c] = 0;
    }
    const double weight = hard ? 1 : 1 / row.compliance;
    shift_[c] += weight * (targets_[r] + middle_ - row.rest);
    weights_[c] += weight;
  }
  for (std::size_t c = 0; c < shift_.size(); ++c) {
    if (set_.roles.of[c] == ComponentRole::kTranslating) shift_[c] /= weights_[c];
  }
}

}  // namespace arap
