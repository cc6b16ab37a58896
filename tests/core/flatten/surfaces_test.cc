// Good surfaces flattened in every way: some made here, and the real ones of ARAP_TEST_DATA.
#include "tests/support/surfaces.h"

#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/mesh/space.h"
#include "tests/core/flatten/fixture.h"
#include "tests/support/compare.h"
#include "tests/support/hemisphere.h"
#include "tests/support/obj.h"

namespace arap::testing {
namespace {

// The energy after the best scale, recomputed from positions alone.
double ScaledEnergy(const SurfaceMesh& mesh, const Flattening& flat) {
  double squares = 0, sums = 0, area = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& c = mesh.triangles[t];
    const Eigen::Vector3d u = Vec(mesh.vertices[c[1]]) - Vec(mesh.vertices[c[0]]);
    const Eigen::Vector3d v = Vec(mesh.vertices[c[2]]) - Vec(mesh.vertices[c[0]]);
    Eigen::Matrix2d rest, image;
    const double length = u.norm(), height = u.cross(v).norm() / length;
    rest << length, u.dot(v) / length, 0, height;
    const Complex e = flat.uv[flat.corner_uv[t][1]] - flat.uv[flat.corner_uv[t][0]];
    const Complex f = flat.uv[flat.corner_uv[t][2]] - flat.uv[flat.corner_uv[t][0]];
    image << e.real(), f.real(), e.imag(), f.imag();
    const Eigen::Matrix2d map = image * rest.inverse();
    // Singular values, the smaller with the sign of the determinant: their squares sum to |map|²,
    // and (s1 + s2)² is that plus twice the determinant.
    const double norm = map.squaredNorm(), det = map.determinant();
    const double weight = 0.5 * length * height;
    squares += weight * norm;
    sums += weight * std::sqrt(std::max(0.0, norm + 2 * det));
    area += weight;
  }
  const double scale = sums / squares;
  return (scale * scale * squares - 2 * scale * sums + 2 * area) / area;
}

struct Disk {
  std::string name;
  SurfaceMesh mesh;
  double best;  // least ARAP energy after the best scale that is known
};

void ExpectNobodyIsBetter(const std::vector<Disk>& disks) {
  FlattenOptions options;
  options.refine = 1000;
  options.refine_stop = 1e-9;
  for (const Disk& disk : disks) {
    const Flattening flat = Must(Flatten(disk.mesh, options));
    EXPECT_LE(ScaledEnergy(disk.mesh, flat), 1.005 * disk.best) << disk.name;
  }
}

// Every edge keeps its length, whatever the cells, the weights and the anchors; first steps too
// where their scale is right.
void ExpectExact(const std::string& name, const SurfaceMesh& mesh) {
  const auto check = [&](const FlattenOptions& options) {
    const Flattening flat = Must(Flatten(mesh, options));
    EXPECT_LE(WorstEdge(mesh, flat.uv), 1e-8)
        << name << ' ' << static_cast<int>(options.method) << ' '
        << static_cast<int>(options.energy.basis) << ' ' << static_cast<int>(options.anchors);
    EXPECT_EQ(flat.distortion.flipped, 0u) << name;
  };
  for (const auto anchors :
       {FlattenAnchors::kCentreEdge, FlattenAnchors::kFarBoundary, FlattenAnchors::kSpectral}) {
    FlattenOptions options;
    options.anchors = anchors;
    for (const Basis basis : {Basis::kEdge, Basis::kEdgeAsPublished, Basis::kFace}) {
      for (const Weights weights : {Weights::kUniform, Weights::kCotangent}) {
        options.energy = {basis, weights, {}};
        check(options);
      }
    }
    if (anchors == FlattenAnchors::kFarBoundary) continue;  // a chord of the surface
    options.energy = {Basis::kFace, Weights::kCotangent, {}};
    for (const auto method : {FlattenMethod::kFirstStep, FlattenMethod::kAbf}) {
      options.method = method;
      check(options);
    }
    options.method = FlattenMethod::kArap;
    options.injective = true;
    check(options);
  }
}

void ExpectNoFlip(const std::vector<Disk>& disks) {
  for (const auto method : {FlattenMethod::kArap, FlattenMethod::kFirstStep}) {
    FlattenOptions options;
    options.method = method;
    options.anchors = FlattenAnchors::kCentreEdge;
    options.injective = true;
    for (const Disk& disk : disks) {
      const Flattening flat = Must(Flatten(disk.mesh, options));
      EXPECT_EQ(flat.distortion.flipped, 0u) << disk.name;
      for (const auto& t : flat.corner_uv) ASSERT_GT(SignedArea(t, flat.uv), 0) << disk.name;
    }
  }
}

struct Way {
  FlattenMethod method;
  Basis basis;
  Weights weights;
  FlattenAnchors anchors;
  int refine;
};

// Finite, not mirrored, and the flips that are reported are those that there are.
void ExpectHonest(const std::string& name, const SurfaceMesh& mesh) {
  const std::vector<Way> ways{
      {FlattenMethod::kArap, Basis::kEdge, Weights::kUniform, FlattenAnchors::kCentreEdge, 0},
      {FlattenMethod::kArap, Basis::kEdgeAsPublished, Weights::kUniform,
       FlattenAnchors::kCentreEdge, 0},
      {FlattenMethod::kArap, Basis::kEdge, Weights::kCotangent, FlattenAnchors::kFarBoundary, 5},
      {FlattenMethod::kArap, Basis::kFace, Weights::kUniform, FlattenAnchors::kSpectral, 0},
      {FlattenMethod::kArap, Basis::kFace, Weights::kCotangent, FlattenAnchors::kSpectral, 20},
      {FlattenMethod::kFirstStep, Basis::kFace, Weights::kCotangent, FlattenAnchors::kSpectral, 0},
      {FlattenMethod::kFirstStep, Basis::kEdge, Weights::kUniform, FlattenAnchors::kFarBoundary, 0},
      {FlattenMethod::kAbf, Basis::kFace, Weights::kCotangent, FlattenAnchors::kSpectral, 0}};
  for (std::size_t way = 0; way < ways.size(); ++way) {
    const Way& w = ways[way];
    FlattenOptions options;
    options.method = w.method;
    options.energy = {w.basis, w.weights, {}};
    options.anchors = w.anchors;
    options.refine = w.refine;
    const Flattening flat = Must(Flatten(mesh, options));
    std::size_t flips = 0;
    double area = 0;
    for (const auto& t : flat.corner_uv) {
      const double signed_area = SignedArea(t, flat.uv);
      ASSERT_TRUE(std::isfinite(signed_area)) << name << ' ' << way;
      flips += signed_area < 0 ? 1u : 0u;
      area += signed_area;
    }
    EXPECT_GT(area, 0) << name << ' ' << way << ": mirrored";
    EXPECT_LT(flips, mesh.triangles.size() / 2) << name << ' ' << way;
    EXPECT_EQ(flat.distortion.flipped, flips) << name << ' ' << way;
  }
}

// ---- Made here

std::vector<Disk> MadeDisks() {
  // A little above the continuous problem's, whose mesh this is.
  const double hemisphere = 1.015 * FlattenHemisphere(2000).arap_energy;
  return {{"roll", RolledSheet(20, 8, 10, 4, 1.5, 1).surface, 1e-14},
          {"accordion", Accordion(8, 6, 4, 1, 2.4, 2).surface, 1e-14},
          {"cone", ConePatch(30, 10, 1, 3, 4.4, 5.9, 3).surface, 1e-14},
          {"hemisphere", SphereCap(32, 128, 0.5 * std::numbers::pi), hemisphere}};
}

TEST(MadeSurfacesTest, RefinedToTheEndNobodyIsBetter) { ExpectNobodyIsBetter(MadeDisks()); }

TEST(MadeSurfacesTest, DevelopablesAreExact) {
  for (const Disk& disk : MadeDisks()) {
    if (disk.name != "hemisphere") ExpectExact(disk.name, disk.mesh);
  }
}

TEST(MadeSurfacesTest, InjectiveLayoutsHaveNoFlip) {
  std::vector<Disk> disks = MadeDisks();
  disks.push_back({"deep cap", SphereCap(20, 30, 2.8), 0});
  ExpectNoFlip(disks);
}

TEST(MadeSurfacesTest, EveryWayIsFiniteUprightAndCountsItsFlips) {
  for (const Disk& disk : MadeDisks()) ExpectHonest(disk.name, disk.mesh);
  const SurfaceMesh band = Band().first;
  ExpectHonest("band", band);
  ExpectHonest("band and cap", Together(band, SphereCap(6, 12, 1.2), {9, 0, 0}));
  ExpectHonest("deep cap", SphereCap(20, 30, 2.8));
}

// ---- The data

class SurfacesDataTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto data = TestData();
    if (!data) GTEST_SKIP() << "ARAP_TEST_DATA is not set: NO real surface is tested";
    folder_ = *data / "3d";
  }

  SurfaceMesh Read(const std::string& name) const {
    SurfaceMesh mesh = ReadObj(folder_ / (name + ".obj"));
    EXPECT_FALSE(mesh.triangles.empty()) << name;
    return mesh;
  }

  // With the least energy that any known program reaches.
  std::vector<Disk> Disks() const {
    std::vector<Disk> disks;
    for (const auto& [name, best] :
         std::vector<std::pair<std::string, double>>{{"dev_accordion", 1e-14},
                                                     {"dev_cone_patch", 1e-14},
                                                     {"dev_rolled_sheet", 1e-14},
                                                     {"near_cylinder_skew", 6.82e-8},
                                                     {"garment_skirt_panel_a", 1.64e-4},
                                                     {"garment_skirt_panel_b", 2.85e-4},
                                                     {"garment_tee_back", 0.00256},
                                                     {"garment_tee_sleeve_a", 4.32e-4},
                                                     {"hemisphere", 0.0292},
                                                     {"spothead", 0.591}}) {
      disks.push_back({name, Read(name), best});
    }
    return disks;
  }

  std::filesystem::path folder_;
};

TEST_F(SurfacesDataTest, RefinedToTheEndNobodyIsBetter) { ExpectNobodyIsBetter(Disks()); }

TEST_F(SurfacesDataTest, DevelopablesAreExact) {
  for (const char* name : {"dev_rolled_sheet", "dev_cone_patch", "dev_accordion"}) {
    ExpectExact(name, Read(name));
  }
}

TEST_F(SurfacesDataTest, InjectiveLayoutsHaveNoFlip) { ExpectNoFlip(Disks()); }

TEST_F(SurfacesDataTest, EveryWayIsFiniteUprightAndCountsItsFlips) {
  for (const Disk& disk : Disks()) ExpectHonest(disk.name, disk.mesh);
  for (const char* name : {"annulus_cylinder", "garment_skirt_annulus", "garment_skirt_welded",
                           "two_components_skirt"}) {
    ExpectHonest(name, Read(name));
  }
}

}  // namespace
}  // namespace arap::testing
