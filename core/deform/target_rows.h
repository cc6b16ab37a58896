// TargetRows: from one target per handle to one target per constraint row, all checked.
#pragma once

#include <span>
#include <vector>

#include "arap/core/deformer.h"
#include "core/deform/compiled_parts.h"

namespace arap {

// Buffers of one stream; Place allocates nothing unless it fails.
class TargetRows {
 public:
  explicit TargetRows(const CompiledHandlesParts& set);

  // Faults: kTargetCount, kNonFiniteTarget, kInvalidOption (scale), kConflictingHandles.
  Status Place(std::span<const Target> given);

  // Mean target of the active rows, normalised. Both steps commute with it; taking it out keeps far
  // targets exact.
  Complex middle() const { return middle_; }
  // Target of a row, normalised, relative to middle().
  Complex operator[](std::size_t row) const { return targets_[row]; }
  // How far the target puts the row's point from the handle, normalised.
  Complex OffsetOf(const Row& row) const {
    return row.offset == 0.0 ? 0.0 : turns_[row.handle] * row.offset;
  }
  // How far a translating component moves, normalised.
  Complex shift(std::size_t component) const { return shift_[component]; }

 private:
  Status Check(std::span<const Target> given) const;
  void PlaceRows(std::span<const Target> given);
  Status CheckFar() const;
  Status CheckDependent() const;
  void PlaceTranslating();

  const CompiledHandlesParts& set_;
  const RegisteredMeshParts& mesh_;
  std::vector<Complex> targets_;  // per row
  std::vector<Complex> turns_;    // per handle with an offset: its rotation and scale
  std::vector<Complex> shift_;    // per component
  std::vector<double> weights_;   // per component, of PlaceTranslating
  std::vector<bool> hard_;        // per component: whether a hard row decides
  Complex middle_;
};

}  // namespace arap
