#include "core/deform/target_rows.h"

#include <cmath>

#include <fmt/format.h>

namespace arap {
namespace {

bool IsFinite(const Target& t) {
  return std::isfinite(t.position.real()) && std::isfinite(t.position.imag()) &&
         std::isfinite(t.angle) && std::isfinite(t.scale);
}

}  // namespace

Complex OffsetAt(const Target& target, Complex offset) {
  if (offset == 0.0) return 0;
  return target.scale * Complex(std::cos(target.angle), std::sin(target.angle)) * offset;
}

TargetRows::TargetRows(const CompiledHandlesParts& set)
    : set_(set),
      mesh_(set.mesh->parts()),
      targets_(set.rows.size()),
      shift_(mesh_.components.size()) {}

Status TargetRows::Place(std::span<const Target> given) {
  if (auto ok = Check(given); !ok) return ok;
  PlaceRows(given);
  if (auto ok = CheckDependent(); !ok) return ok;
  PlaceTranslating();
  return {};
}

Status TargetRows::Check(std::span<const Target> given) const {
  if (given.size() != set_.handles.size()) {
    Fault fault = Fault(FaultKind::kTargetCount,
                        fmt::format("{} targets for {} handles", given.size(), set_.handles.size()))
                      .Field("targets");
    fault.Detail("count", fmt::to_string(given.size()))
        .Detail("expected", fmt::to_string(set_.handles.size()));
    return Fail(std::move(fault));
  }
  for (std::size_t h = 0; h < given.size(); ++h) {
    const std::string& id = set_.handles[h].handle.id;
    if (!IsFinite(given[h])) {
      return Fail(Fault(FaultKind::kNonFiniteTarget,
                        fmt::format("the target of handle \"{}\" is NaN or infinite", id))
                      .Field("targets")
                      .Element(static_cast<std::uint32_t>(h))
                      .Detail("handle", id));
    }
    if (given[h].scale < 0) {
      return Fail(Fault(FaultKind::kInvalidOption,
                        fmt::format("the scale of handle \"{}\" is {}; it must be at least 0", id,
                                    given[h].scale))
                      .Field("targets")
                      .Element(static_cast<std::uint32_t>(h))
                      .Detail("handle", id));
    }
  }
  return {};
}

void TargetRows::PlaceRows(std::span<const Target> given) {
  for (std::size_t r = 0; r < set_.rows.size(); ++r) {
    const Row& row = set_.rows[r];
    const Target& target = given[row.handle];
    targets_[r] = mesh_.Normalise(target.position);
    targets_[r] += OffsetAt(target, row.offset);
  }
  middle_ = 0;
  for (const std::size_t r : set_.active_rows) middle_ += targets_[r];
  if (!set_.active_rows.empty()) middle_ /= static_cast<double>(set_.active_rows.size());
  for (Complex& c : targets_) c -= middle_;
}

Status TargetRows::CheckDependent() const {
  for (const DependentRow& dependent : set_.dependent) {
    Complex expected = 0;
    double size = std::abs(targets_[dependent.row]) + 1;
    for (const auto& [row, coefficient] : dependent.combination) {
      expected += coefficient * targets_[row];
      size += std::abs(coefficient * targets_[row]);
    }
    const double gap = std::abs(expected - targets_[dependent.row]);
    if (gap <= kCoincident * size) continue;
    const std::uint32_t h = set_.rows[dependent.row].handle;
    Fault fault = Fault(FaultKind::kConflictingHandles, "").Field("targets").Element(h);
    std::string others;
    for (const auto& [row, coefficient] : dependent.combination) {
      const std::uint32_t other = set_.rows[row].handle;
      fault.Element(other);
      others += fmt::format("{}\"{}\"", others.empty() ? "" : ", ", set_.handles[other].handle.id);
    }
    fault.message = fmt::format(
        "hard handle \"{}\" cannot meet its target: {} decide its place, which is {} away; make "
        "one "
        "of them soft",
        set_.handles[h].handle.id, others, gap * mesh_.report.diagonal);
    fault.Detail("distance", fmt::to_string(gap * mesh_.report.diagonal));
    return Fail(std::move(fault));
  }
  return {};
}

// A component with one distinct point follows it: soft handles average by weight, hard ones decide.
void TargetRows::PlaceTranslating() {
  for (std::size_t c = 0; c < shift_.size(); ++c) {
    shift_[c] = 0;
    if (set_.roles[c] != ComponentRole::kTranslating) continue;
    double weights = 0;
    bool hard = false;
    for (std::size_t r = 0; r < set_.rows.size(); ++r) {
      const Row& row = set_.rows[r];
      if (row.component != c || (hard && row.compliance > 0)) continue;
      if (row.compliance == 0 && !hard) {
        hard = true;
        shift_[c] = weights = 0;
      }
      const double weight = hard ? 1 : 1 / row.compliance;
      shift_[c] += weight * (targets_[r] + middle_ - row.rest);
      weights += weight;
    }
    shift_[c] /= weights;
  }
}

}  // namespace arap
