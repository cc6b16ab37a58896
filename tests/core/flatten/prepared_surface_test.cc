// A surface prepared once: the same answers as a fresh call, and nothing is factored again.
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "tests/core/flatten/fixture.h"
#include "tests/support/surfaces.h"

namespace arap::testing {
namespace {

// The second time nothing is factored, the answer is the same, and other pins start from the same
// charts.
TEST(PreparedSurfaceTest, AnswersAlike) {
  const SurfaceMesh cap = SphereCap(8, 20, 1.2);
  const auto prepared = Must(Prepare(cap, {}));
  EXPECT_GT(prepared->bytes(), 0u);
  FlattenOptions options = Refined();
  const Flattening alone = Must(Flatten(cap, options));
  const Flattening first = Must(Flatten(*prepared, options));
  const std::size_t bytes = prepared->bytes();
  const Flattening second = Must(Flatten(*prepared, options));
  EXPECT_EQ(prepared->bytes(), bytes);
  EXPECT_EQ(first.uv, alone.uv);
  EXPECT_EQ(second.uv, alone.uv);
  options.pins = {{3, {0, 0}, 0}, {100, {1, 0}, 0}};
  const Flattening pinned = Must(Flatten(*prepared, options));
  EXPECT_EQ(pinned.uv, Must(Flatten(cap, options)).uv);
  EXPECT_EQ(prepared->bytes(), bytes) << "pins need no factor of their own";
  options.pins[1].uv = {1.1, 0.2};  // the same vertices elsewhere: the same factors
  EXPECT_EQ(Must(Flatten(*prepared, options)).uv, Must(Flatten(cap, options)).uv);
  EXPECT_EQ(prepared->bytes(), bytes);
}

// What was asked before leaves no trace, not in the last bit: the order of elimination, which
// rounding follows, is one for all layouts of a basis.
TEST(PreparedSurfaceTest, ForgetsWhatWasAsked) {
  const SurfaceMesh cap = SphereCap(8, 20, 1.2);
  const auto prepared = Must(Prepare(cap, {}));
  std::vector<FlattenOptions> asked;
  for (const auto anchors :
       {FlattenAnchors::kSpectral, FlattenAnchors::kFarBoundary, FlattenAnchors::kCentreEdge}) {
    for (const Basis basis : {Basis::kEdge, Basis::kEdgeAsPublished, Basis::kFace}) {
      for (const Weights weights : {Weights::kUniform, Weights::kCotangent}) {
        for (const auto method :
             {FlattenMethod::kArap, FlattenMethod::kFirstStep, FlattenMethod::kAbf}) {
          const bool face = basis == Basis::kFace && weights == Weights::kCotangent;
          if (method == FlattenMethod::kAbf && !face) continue;
          FlattenOptions& options = asked.emplace_back(Refined());
          options.method = method;
          options.energy = {basis, weights, {}};
          options.anchors = anchors;
        }
      }
    }
  }
  for (int round = 0; round < 2; ++round) {
    for (const FlattenOptions& options : asked) {
      EXPECT_EQ(Must(Flatten(*prepared, options)).uv, Must(Flatten(cap, options)).uv);
    }
  }
}

TEST(PreparedSurfaceTest, ManyChartsKeepTheirFactors) {
  SurfaceMesh many = SphereCap(3, 6, 1.0);
  for (int i = 1; i < 12; ++i) many = Together(many, SphereCap(3, 6, 1.0), {3.0 * i, 0, 0});
  const auto prepared = Must(Prepare(many, {}));
  const Flattening first = Must(Flatten(*prepared, Refined()));
  const std::size_t bytes = prepared->bytes();
  const Flattening second = Must(Flatten(*prepared, Refined()));
  EXPECT_EQ(first.uv, second.uv);
  EXPECT_EQ(prepared->bytes(), bytes);
  EXPECT_EQ(second.times.order, 0);
  EXPECT_EQ(second.times.factor, 0);
  EXPECT_FALSE(first.overlaps);
}

TEST(FlattenTimesTest, EveryPhaseOfAWholeRunTakesTime) {
  const auto flat = Flatten(SphereCap(12, 24, 1.2), Refined());
  ASSERT_TRUE(flat);
  EXPECT_GT(flat->times.topology, 0);
  EXPECT_GT(flat->times.order, 0);
  EXPECT_GT(flat->times.factor, 0);
  EXPECT_GT(flat->times.solve, 0);
  EXPECT_DOUBLE_EQ(flat->times.total(), flat->times.topology + flat->times.order +
                                            flat->times.factor + flat->times.solve);
}

TEST(FlattenTimesTest, WhatIsKeptCostsNothing) {
  const auto surface = Prepare(SphereCap(12, 24, 1.2), {});
  ASSERT_TRUE(surface);
  const auto first = Flatten(**surface, Refined());
  const auto second = Flatten(**surface, Refined());
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->times.topology, 0);
  EXPECT_GT(first->times.order, 0);
  EXPECT_GT(first->times.factor, 0);
  EXPECT_EQ(second->times.order, 0);
  EXPECT_EQ(second->times.factor, 0);
  EXPECT_GT(second->times.solve, 0);
  EXPECT_EQ(first->uv, second->uv);
}

// Kept surfaces, other pins.
class RepinTest : public ::testing::Test {
 protected:
  RepinTest() : cap_(SphereCap(12, 24, 1.4)), kept_(Must(Prepare(cap_, {}))) {
    options_.refine = 5;
    free_ = Must(Flatten(cap_, options_)).uv;
  }

  // Nothing factored, and the bytes of a fresh call.
  void ExpectReuse(const FlattenOptions& options) {
    const Flattening again = Must(Flatten(*kept_, options));
    EXPECT_EQ(again.times.order, 0);
    EXPECT_EQ(again.times.factor, 0);
    const Flattening fresh = Must(Flatten(cap_, options));
    EXPECT_GT(fresh.times.factor, 0);
    EXPECT_EQ(again.uv, fresh.uv);
    EXPECT_EQ(again.first_step, fresh.first_step);
  }

  FlattenOptions With(std::size_t pins, PinKind kind, std::uint64_t seed) const {
    FlattenOptions options = options_;
    options.pins = RandomPins(free_, Diagonal(cap_), pins, kind, seed);
    return options;
  }

  SurfaceMesh cap_;
  std::shared_ptr<const PreparedSurface> kept_;
  FlattenOptions options_;
  std::vector<Complex> free_;
};

TEST_F(RepinTest, OtherPinsFactorNothing) {
  for (const Basis basis : {Basis::kFace, Basis::kEdge}) {
    options_.energy.basis = basis;
    Must(Flatten(*kept_, With(3, PinKind::kMixed, 1)));
    const std::size_t bytes = kept_->bytes();
    std::uint64_t seed = 1;
    for (const std::size_t count : {2u, 3u, 10u, 32u}) {
      for (const PinKind kind : {PinKind::kHard, PinKind::kSoft, PinKind::kMixed}) {
        ExpectReuse(With(count, kind, ++seed));
      }
    }
    EXPECT_EQ(kept_->bytes(), bytes);
  }
}

TEST_F(RepinTest, OtherWeightsFactorNothing) {
  FlattenOptions options = With(6, PinKind::kSoft, 3);
  Must(Flatten(*kept_, options));
  for (const double weight : {1e-2, 1.0, 1e4, 0.0}) {
    for (UvPin& pin : options.pins) pin.weight = weight;
    ExpectReuse(options);
  }
}

TEST_F(RepinTest, PinsAfterNoneFactorNothing) {
  Must(Flatten(*kept_, options_));
  ExpectReuse(With(4, PinKind::kMixed, 5));
  ExpectReuse(options_);
}

// More pins than the shared factors are good for: factored in, with the order that is there.
TEST_F(RepinTest, ManyPinsKeepTheOrder) {
  Must(Flatten(*kept_, options_));
  const FlattenOptions many = With(kDirectPins + 1, PinKind::kMixed, 6);
  const Flattening again = Must(Flatten(*kept_, many));
  EXPECT_EQ(again.uv, Must(Flatten(cap_, many)).uv);
  EXPECT_GT(again.times.factor, 0);
  ExpectReuse(many);
  for (const UvPin& pin : many.pins) {
    if (pin.weight == 0) {
      EXPECT_EQ(again.uv[pin.vertex], pin.uv);
    }
  }
}

// Other edge weights are another matrix of the same pattern: a factor of its own, made with the
// order that is there, with the bytes of a fresh call.
TEST_F(RepinTest, OtherEnergiesKeepTheOrder) {
  options_.energy.basis = Basis::kEdge;
  Must(Flatten(*kept_, options_));
  FlattenOptions uniform = options_;
  uniform.energy.weights = Weights::kUniform;
  const Flattening again = Must(Flatten(*kept_, uniform));
  EXPECT_GT(again.times.factor, 0);
  EXPECT_EQ(again.uv, Must(Flatten(cap_, uniform)).uv);
  ExpectReuse(uniform);
  ExpectReuse(options_);
}

}  // namespace
}  // namespace arap::testing
