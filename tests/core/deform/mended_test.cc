// Meshes that were mended: their shapes are those of the mesh as it should have been, told in the vertices
// and triangles that were given.
#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include <gmock/gmock.h>

#include "arap/core/pick.h"
#include "tests/core/deform/fixture.h"
#include "tests/support/meshes.h"

namespace arap::testing::mended {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

std::shared_ptr<const RegisteredMesh> Mended(const PlanarMesh& mesh, const RepairOptions& repairs,
                                             const EnergyOptions& energy = {}) {
  return Must(RegisteredMesh::Register(mesh, energy, repairs));
}

std::vector<std::string> Kinds(const RegisteredMesh& mesh) {
  std::vector<std::string> kinds;
  for (const Warning& warning : mesh.report().warnings) kinds.push_back(warning.kind);
  return kinds;
}

// A bar of 10 × 2, and the same in two halves that have vertices of their own at x = 5. `copy[v]` is the
// vertex of the whole one.
struct Bars {
  PlanarMesh whole, halves;
  std::vector<std::uint32_t> copy;
};
Bars MakeBars() {
  Bars bars;
  bars.whole = Grid(10, 2, 10, 2);
  bars.halves = bars.whole;
  for (std::uint32_t v = 0; v < 33; ++v) bars.copy.push_back(v);
  for (Triangle& t : bars.halves.triangles) {
    double middle = 0;
    for (const std::uint32_t v : t) middle += bars.whole.vertices[v].real() / 3;
    if (middle < 5) continue;
    for (std::uint32_t& v : t) {
      if (bars.whole.vertices[v].real() == 5) v = 33 + v / 11;
    }
  }
  for (std::uint32_t j = 0; j < 3; ++j) {
    bars.halves.vertices.push_back(bars.whole.vertices[11 * j + 5]);
    bars.copy.push_back(11 * j + 5);
  }
  return bars;
}

std::vector<Target> Bent(const CompiledHandles& set) {
  std::vector<Target> targets = set.RestTargets();
  targets.back().position += Complex(-2, 5);
  return targets;
}

TEST(MendedTest, WeldedHalvesBendAsTheWhole) {
  const Bars bars = MakeBars();
  for (const Basis basis : {Basis::kEdge, Basis::kFace, Basis::kVertex}) {
    const auto torn = Register(bars.halves, basis);
    EXPECT_THAT(Kinds(*torn), ElementsAre("twin_vertices"));
    EXPECT_EQ(torn->report().warnings[0].count, 3u);
    EXPECT_EQ(torn->report().components, 2u);

    const auto mended = Mended(bars.halves, {.weld = true}, {basis, Weights::kUniform, {}});
    EXPECT_THAT(Kinds(*mended), ElementsAre("welded_vertices"));
    EXPECT_EQ(mended->report().components, 1u);
    EXPECT_EQ(mended->report().vertices, 36u);
    EXPECT_EQ(mended->report().triangles, 40u);
    // On the twin or on the vertex that stands for it.
    const auto whole = Compile(Register(bars.whole, basis),
                               {OnVertex("a", 11), OnVertex("m", 16), OnVertex("b", 21)});
    const auto expected = Deform(whole, Bent(*whole));
    for (const std::uint32_t twin : {16u, 34u}) {
      const auto set = Compile(mended, {OnVertex("a", 11), OnVertex("m", twin), OnVertex("b", 21)});
      const auto shape = Deform(set, Bent(*set));
      ASSERT_THAT(shape, SizeIs(36));
      for (std::size_t v = 0; v < shape.size(); ++v) {
        EXPECT_LE(std::abs(shape[v] - expected[bars.copy[v]]), 1e-9) << v;
      }
      EXPECT_EQ(shape[34], shape[16]);
    }
  }
}

TEST(MendedTest, DuplicatesAreLeftOut) {
  PlanarMesh mesh = Grid(3, 3, 3, 3);
  const auto whole = Compile(Register(mesh), {OnVertex("a", 0), OnVertex("b", 15)});
  const auto [a, b, c] = mesh.triangles[4];
  mesh.triangles.insert(mesh.triangles.begin(), {b, a, c});
  mesh.triangles.push_back({c, a, b});
  const auto refused = RegisteredMesh::Register(mesh, {});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, FaultKind::kDuplicateTriangle);
  EXPECT_THAT(refused.error().message, HasSubstr("2 such in all; 2 of them run the other way"));
  EXPECT_THAT(refused.error().message, HasSubstr("drop_duplicates"));
  const auto mended = Mended(mesh, {.drop_duplicates = true});
  EXPECT_EQ(mended->report().triangles, 20u);
  const auto set =
      Compile(mended, {OnVertex("a", 0), OnVertex("b", 15), InTriangle("c", 19, {0.5, 0.3, 0.2})});
  EXPECT_LE(std::abs(set->handles()[2].rest -
                     (0.5 * mesh.vertices[c] + 0.3 * mesh.vertices[a] + 0.2 * mesh.vertices[b])),
            1e-12);
  const auto two = Compile(mended, {OnVertex("a", 0), OnVertex("b", 15)});
  const auto shape = Deform(two, Bent(*two)), expected = Deform(whole, Bent(*whole));
  for (std::size_t v = 0; v < shape.size(); ++v) {
    EXPECT_LE(std::abs(shape[v] - expected[v]), 1e-9);
  }
}

// [0, 1] × [0, 2] in one square and [1, 2] × [0, 2] in two, which share the ends of x = 1.
PlanarMesh WithTJunction() {
  return {{{0, 0}, {1, 0}, {0, 2}, {1, 2}, {2, 0}, {2, 1}, {2, 2}, {1, 1}},
          {{0, 1, 3}, {0, 3, 2}, {1, 4, 5}, {1, 5, 7}, {7, 5, 6}, {7, 6, 3}}};
}

TEST(MendedTest, StitchedTrianglesAreSpokenOfAsTheyWereGiven) {
  const PlanarMesh mesh = WithTJunction();
  EXPECT_THAT(Kinds(*Register(mesh)), Contains("t_junctions"));
  const auto mended =
      Mended(mesh, {.stitch = true}, {Basis::kFace, Weights::kUniform, {1, 2, 3, 4, 5, 6}});
  EXPECT_THAT(Kinds(*mended), ElementsAre("split_triangles"));
  EXPECT_EQ(mended->report().triangles, 6u);
  EXPECT_EQ(mended->report().boundary_loops, 1u);
  EXPECT_EQ(mended->mesh().triangles.size(), 7u);
  Handle deep = InTriangle("in", 0, {0.2, 0.5, 0.3});
  deep.depth = 1;
  const auto set = Compile(mended, {OnVertex("a", 2), OnVertex("b", 4), deep});
  const Complex rest = 0.2 * mesh.vertices[0] + 0.5 * mesh.vertices[1] + 0.3 * mesh.vertices[3];
  EXPECT_LE(std::abs(set->handles()[2].rest - rest), 1e-12);

  const auto targets = Bent(*set);
  const auto shape = Deform(set, targets);
  const Complex moved = targets[2].position;
  const auto pick = Must(FindPicks(*set, shape, {&moved, 1})).front();
  ASSERT_TRUE(pick);
  EXPECT_EQ(pick->triangle, 0u);
  EXPECT_LE(std::abs(pick->rest - rest), 1e-3);
  Complex again = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    again += pick->barycentric[k] * mesh.vertices[mesh.triangles[0][k]];
  }
  EXPECT_LE(std::abs(again - pick->rest), 1e-12);

  auto order = DrawOrder(*set);
  std::sort(order.begin(), order.end());
  EXPECT_THAT(order, ElementsAre(0, 1, 2, 3, 4, 5));
  EXPECT_THAT(VertexDepths(*set), SizeIs(8));
  // Turned over, every triangle is flipped, and each is told once.
  std::vector<Target> over = set->RestTargets();
  for (Target& t : over) t.position = std::conj(t.position);
  over[0].position += Complex(0, 1e-3);
  Deformer deformer(set);
  Must(deformer.Update(over));
  for (const std::uint32_t t : deformer.FlippedTriangles()) EXPECT_LT(t, 6u);
  const auto flipped = deformer.FlippedTriangles();
  EXPECT_EQ(std::set(flipped.begin(), flipped.end()).size(), flipped.size());
  EXPECT_EQ(CompiledHandles::Compile(mended, {InTriangle("x", 6, {1, 0, 0})}).error().kind,
            FaultKind::kIndexOutOfRange);
}

TEST(MendedTest, WhatIsAskedAmissIsAFault) {
  const PlanarMesh mesh = WithTJunction();
  const auto large = RegisteredMesh::Register(mesh, {}, {.weld = true, .tolerance = 1});
  ASSERT_FALSE(large);
  EXPECT_EQ(large.error().field, "repair.tolerance");
  const auto rigidity =
      RegisteredMesh::Register(mesh, {Basis::kFace, Weights::kUniform, {1, 2}}, {.stitch = true});
  ASSERT_FALSE(rigidity);
  EXPECT_EQ(rigidity.error().kind, FaultKind::kArrayLength);
  EXPECT_EQ(DetailOf(rigidity.error(), "expected"), "6");
}

}  // namespace
}  // namespace arap::testing::mended
