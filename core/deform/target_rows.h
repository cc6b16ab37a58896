// TargetRows: from one target per handle to one target per constraint row, all checked.
#pragma once

#include <span>
#include <vector>

#include "arap/core/deformer.h"
#include "core/deform/compiled_parts.h"

namespace arap {

// Where the target puts a point that lies `offset` from the handle at rest. Unit of the offset.
Complex OffsetAt(const Target& target, Complex offset);

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
  // How far a translating component moves, normalised.
  Complex shift(std::size_t component) const { return shift_[component]; }

 private:
  Status Check(std::span<const Target> given) const;
  void PlaceRows(std::span<const Target> given);
  Status CheckDependent() const;
  void PlaceTranslating();

  const CompiledHandlesParts& set_;
  const RegisteredMeshParts& mesh_;
  std::vector<Complex> targets_;  // per row
  std::vector<Complex> shift_;    // per component
  std::vector<double> weights_;   // per component, of PlaceTranslating
  std::vector<bool> hard_;        // per component: whether a hard row decides
  Complex middle_;
};

}  // namespace arap
