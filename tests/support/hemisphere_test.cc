// The one-dimensional minimiser against the closed form of its Euler–Lagrange equation.
#include "tests/support/hemisphere.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace arap::testing {
namespace {

// With u = tan(θ/2) the equation sin θ r″ + cos θ r′ − r/sin θ = cos θ − 1 is solved by
// ln(1 + u²)/u + C u; r′ = 1 at the free rim asks for C = ln 2.
double ExactRadius(double theta) {
  const double u = std::tan(0.5 * theta);
  return u == 0 ? 0 : std::log1p(u * u) / u + u * std::numbers::ln2;
}

TEST(HemisphereTest, RadiusIsTheClosedForm) {
  const std::size_t n = 2000;
  const FlatHemisphere flat = FlattenHemisphere(n);
  ASSERT_EQ(flat.radius.size(), n + 1);
  for (std::size_t k = 0; k <= n; ++k) {
    const double theta = 0.5 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n);
    EXPECT_NEAR(flat.radius[k], ExactRadius(theta), 1e-6);
  }
  EXPECT_NEAR(flat.radius[n], 2 * std::numbers::ln2, 1e-6);
}

TEST(HemisphereTest, TheEnergyConvergesWithTheSquareOfTheElements) {
  const double a = FlattenHemisphere(250).arap_energy;
  const double b = FlattenHemisphere(500).arap_energy;
  const double c = FlattenHemisphere(1000).arap_energy;
  EXPECT_NEAR((a - b) / (b - c), 4, 0.1);
  const double limit = c + (c - b) / 3;  // Richardson
  EXPECT_NEAR(FlattenHemisphere(4000).arap_energy, limit, 1e-6 * limit);
}

TEST(HemisphereTest, OtherProfilesAreWorse) {
  const double least = FlattenHemisphere(2000).arap_energy;
  const auto energy = [](auto radius, auto slope) {
    const int n = 20'000;
    const double h = 0.5 * std::numbers::pi / n;
    double sum = 0;
    for (int k = 0; k < n; ++k) {
      const double theta = h * (k + 0.5), sine = std::sin(theta);
      sum += h * sine * (std::pow(slope(theta) - 1, 2) + std::pow(radius(theta) / sine - 1, 2));
    }
    return sum;
  };
  const auto exact_slope = [](double t) {
    return (ExactRadius(t + 1e-5) - ExactRadius(t - 1e-5)) / 2e-5;
  };
  EXPECT_NEAR(energy(ExactRadius, exact_slope), least, 1e-5 * least);
  EXPECT_GT(energy([](double t) { return t; }, [](double) { return 1.0; }), 1.1 * least);
  EXPECT_GT(energy([](double t) { return std::sin(t); }, [](double t) { return std::cos(t); }),
            1.1 * least);
  for (const double scale : {0.98, 1.02}) {
    EXPECT_GT(energy([&](double t) { return scale * ExactRadius(t); },
                     [&](double t) { return scale * exact_slope(t); }),
              least);
  }
}

}  // namespace
}  // namespace arap::testing
