// Every good surface of the data folder, flattened in every way.
#include <cmath>
#include <map>

#include "arap/core/flattener.h"
#include "core/mesh/space.h"
#include "tests/core/property/fixture.h"
#include "tests/support/compare.h"
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

class FlattenDataTest : public ::testing::Test {
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

  std::filesystem::path folder_;
};

// Disks with the least ARAP energy after the best scale that any known program reaches.
const std::map<std::string, double> kDisks{{"dev_accordion", 1e-14},
                                           {"dev_cone_patch", 1e-14},
                                           {"dev_rolled_sheet", 1e-14},
                                           {"near_cylinder_skew", 6.82e-8},
                                           {"garment_skirt_panel_a", 1.64e-4},
                                           {"garment_skirt_panel_b", 2.85e-4},
                                           {"garment_tee_back", 0.00256},
                                           {"garment_tee_sleeve_a", 4.32e-4},
                                           {"hemisphere", 0.0292},
                                           {"spothead", 0.591}};
const std::vector<std::string> kOthers{"annulus_cylinder", "garment_skirt_annulus",
                                       "garment_skirt_welded", "two_components_skirt"};

TEST_F(FlattenDataTest, RefinedToTheEndNobodyIsBetter) {
  FlattenOptions options;
  options.refine = 1000;
  options.refine_stop = 1e-9;
  for (const auto& [name, best] : kDisks) {
    const SurfaceMesh mesh = Read(name);
    const Flattening flat = Must(Flatten(mesh, options));
    EXPECT_LE(ScaledEnergy(mesh, flat), 1.005 * best) << name;
  }
}

// Every edge keeps its length, whatever the cells, the weights and the anchors; first steps too
// where their scale is right.
TEST_F(FlattenDataTest, DevelopablesAreExact) {
  for (const char* name : {"dev_rolled_sheet", "dev_cone_patch", "dev_accordion"}) {
    const SurfaceMesh mesh = Read(name);
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
}

TEST_F(FlattenDataTest, InjectiveLayoutsHaveNoFlip) {
  for (const auto method : {FlattenMethod::kArap, FlattenMethod::kFirstStep}) {
    FlattenOptions options;
    options.method = method;
    options.anchors = FlattenAnchors::kCentreEdge;
    options.injective = true;
    for (const auto& [name, best] : kDisks) {
      const SurfaceMesh mesh = Read(name);
      const Flattening flat = Must(Flatten(mesh, options));
      EXPECT_EQ(flat.distortion.flipped, 0u) << name;
      for (const auto& t : flat.corner_uv) ASSERT_GT(SignedArea(t, flat.uv), 0) << name;
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

TEST_F(FlattenDataTest, EveryWayIsFiniteUprightAndCountsItsFlips) {
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
  std::vector<std::string> names = kOthers;
  for (const auto& [name, best] : kDisks) names.push_back(name);
  for (const std::string& name : names) {
    const SurfaceMesh mesh = Read(name);
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
}

}  // namespace
}  // namespace arap::testing
