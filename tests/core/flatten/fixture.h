// What the tests of flattening share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "arap/core/flattener.h"
#include "tests/support/must.h"

namespace arap::testing {

// Twenty refinements at most.
FlattenOptions Refined();

// What every answer must keep, whatever was asked.
void CheckSound(const SurfaceMesh& mesh, const Flattening& flat);

inline constexpr std::uint32_t kAround = 24, kAcross = 4;

// A closed band of kAround × kAcross cells and the seam that opens it.
std::pair<SurfaceMesh, CutOptions> Band();

enum class PinKind { kHard, kSoft, kMixed };

// `count` vertices pulled away from where `free` has them, by up to a tenth of `diagonal`.
std::vector<UvPin> RandomPins(const std::vector<Complex>& free, double diagonal, std::size_t count,
                              PinKind kind, std::uint64_t seed);

// Of the bounding box.
double Diagonal(const SurfaceMesh& mesh);

}  // namespace arap::testing
