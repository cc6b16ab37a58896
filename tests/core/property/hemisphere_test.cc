// A refined hemisphere reaches the energy of the continuous problem.
#include "tests/support/hemisphere.h"

#include <cmath>
#include <numbers>

#include "arap/core/flattener.h"
#include "tests/core/property/fixture.h"
#include "tests/support/surfaces.h"

namespace arap::testing {
namespace {

// The rim of every mesh is the equator. Errors that fall from mesh to mesh tell a limit from a
// coincidence.
TEST(HemisphereFlattenTest, ReachesTheContinuousEnergy) {
  const double continuous = FlattenHemisphere(2000).arap_energy;
  double last = 1;
  for (const std::size_t rings : {8u, 16u, 32u}) {
    const SurfaceMesh hemisphere = SphereCap(rings, 4 * rings, 0.5 * std::numbers::pi);
    FlattenOptions options;
    options.energy = {Basis::kFace, Weights::kCotangent, {}};
    options.refine = 200;
    const Flattening flat = Must(Flatten(hemisphere, options));
    const double error = std::abs(flat.distortion.arap_energy / continuous - 1);
    EXPECT_LT(error, 0.5 * last) << rings;
    last = error;
  }
  EXPECT_LE(last, 0.02);
}

}  // namespace
}  // namespace arap::testing
