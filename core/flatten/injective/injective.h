// Layouts without a single flipped triangle.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/model/mesh.h"
#include "core/flatten/injective/newton.h"

namespace arap {

struct InjectiveOptions {
  // Steps of the descent; mending a start has its own patience.
  int max_iterations = 200;
  // The descent ends when a step lowers what the energy has above 4 by less than this fraction.
  double stop = 1e-6;
  // Vertices held in the plane, in units of the normalised mesh; any number. Hard ones (infinite
  // weight) are met exactly or there is no layout; soft ones add weight·|z − uv|² to the mean
  // energy of a triangle, so that 1 is gentle and 1e4 is firm.
  std::vector<LayoutPin> pins;
  std::vector<bool> left_out;  // #F or empty: degenerate triangles, which do not count
};

// Where the descent began.
enum class InjectiveStart {
  kGiven,   // the candidate had no flip
  kTutte,   // Tutte's embedding
  kMended,  // one of these after it was pulled to the pins or its flips were pushed out
};

struct InjectiveLayout {
  std::vector<Complex> uv;  // #V
  InjectiveStart start = InjectiveStart::kGiven;
  int iterations = 0;  // steps of all kinds, those of mending included
  double energy = 4;   // symmetric Dirichlet energy, area-weighted; 4 is an isometry
  FactorTimes times;   // of the factors of both descents
};

// Mends the candidate around its flips, where these are few, or starts from Tutte's embedding, and
// descends the symmetric Dirichlet energy by steps that never collapse a triangle: conjugate
// gradients first, projected Newton steps where these do not come to an end.
// `mesh` is valid, oriented, connected, of genus 0 and normalised to a unit diagonal; `loops` are
// its boundary loops (at least one, ordered as the triangles run), longest first; `start` (#V) is a
// candidate, flips and all, in the plane of the pins; it may be empty. Every triangle of the answer
// that counts is upright by more than rounding (Upright), and no inner vertex is wound twice; far
// parts of the layout may still overlap. An isometric start comes back as it is.
//
// Stateless, deterministic. Some 0.05 ms per 1000 triangles and step of conjugate gradients, seldom
// 150, and 1 ms for one of Newton's.
// Faults: kNotInjective when no such layout was reached (nothing is returned then); kInvalidOption
// for pins that name no vertex, one twice, or are not numbers; kNumerical; what `cancel` answers
// between iterations. [Smith and Schaefer 2015; Rabinovich et al. 2017; untangling: Garanzha et al.
// 2021]
Result<InjectiveLayout> FlattenInjective(const SurfaceMesh& mesh,
                                         std::span<const std::vector<std::uint32_t>> loops,
                                         std::span<const Complex> start,
                                         const InjectiveOptions& options,
                                         const CancelToken& cancel = {});

}  // namespace arap
