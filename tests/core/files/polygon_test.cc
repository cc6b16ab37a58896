#include "core/files/polygon.h"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>

namespace arap {
namespace {

using testing::ElementsAre;

std::vector<std::uint32_t> AllOf(std::span<const Point3> vertices) {
  std::vector<std::uint32_t> corners(vertices.size());
  for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = static_cast<std::uint32_t>(i);
  return corners;
}

// Twice the area vector of a triangle.
Point3 AreaOf(const std::vector<Point3>& v, const Triangle& t) {
  const auto side = [&](std::size_t k, std::size_t i) { return v[t[k]][i] - v[t[0]][i]; };
  Point3 area{};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    area[i] = side(1, j) * side(2, k) - side(1, k) * side(2, j);
  }
  return area;
}

struct Shape {
  const char* name;
  std::vector<Point3> vertices;
  PolygonCut cut;
};

std::ostream& operator<<(std::ostream& out, const Shape& shape) { return out << shape.name; }

std::vector<Point3> Star(std::size_t points, double inner) {
  std::vector<Point3> star;
  for (std::size_t i = 0; i < 2 * points; ++i) {
    const double angle = std::numbers::pi * static_cast<double>(i) / static_cast<double>(points);
    const double radius = i % 2 == 0 ? 1 : inner;
    star.push_back({radius * std::cos(angle), radius * std::sin(angle), 0});
  }
  return star;
}

// A comb: a long back, and teeth with straight sides that have a corner in their middle.
std::vector<Point3> Comb(int teeth) {
  std::vector<Point3> comb{{0, -1, 0}, {2.0 * teeth, -1, 0}};
  for (int i = teeth; i-- > 0;) {
    comb.insert(comb.end(), {{2.0 * i + 2, 0, 0},
                             {2.0 * i + 1.5, 0, 0},
                             {2.0 * i + 1.5, 2, 0},
                             {2.0 * i + 1.5, 4, 0},
                             {2.0 * i + 0.5, 4, 0},
                             {2.0 * i + 0.5, 0, 0}});
  }
  return comb;
}

class PolygonTest : public testing::TestWithParam<Shape> {};

// In its own plane, in a slanted one, far away, huge and tiny: all triangles have the direction of
// the polygon, none is without area, and together they have its area.
TEST_P(PolygonTest, IsCoveredOnce) {
  const std::vector<Point3>& flat = GetParam().vertices;
  double twice_area = 0;
  for (std::size_t i = 0; i < flat.size(); ++i) {
    const Point3 &a = flat[i], &b = flat[(i + 1) % flat.size()];
    twice_area += a[0] * b[1] - a[1] * b[0];
  }
  for (const double scale : {1.0, 1e-200, 1e200}) {
    for (const bool slanted : {false, true}) {
      for (std::size_t turn = 0; turn < flat.size(); ++turn) {
        std::vector<Point3> moved;
        for (std::size_t i = 0; i < flat.size(); ++i) {
          const auto& [x, y, z] = flat[(i + turn) % flat.size()];
          moved.push_back(slanted ? Point3{scale * 0.6 * x, scale * y, scale * 0.8 * x}
                                  : Point3{scale * x, scale * y, scale * z});
        }
        std::vector<Triangle> triangles;
        const PolygonCut cut = CutPolygon(moved, AllOf(moved), triangles);
        // A concave one may be a fan from one of its corners.
        if (GetParam().cut == PolygonCut::kFan) {
          EXPECT_EQ(cut, PolygonCut::kFan);
        }
        EXPECT_TRUE(cut == PolygonCut::kFan || cut == PolygonCut::kEars);
        ASSERT_EQ(triangles.size(), flat.size() - 2);
        double sum = 0;
        for (const Triangle& t : triangles) {
          std::vector<Point3> unit = moved;
          for (Point3& p : unit) p = {p[0] / scale, p[1] / scale, p[2] / scale};
          const Point3 area = AreaOf(unit, t);
          const double along = slanted ? 0.6 * area[2] - 0.8 * area[0] : area[2];
          EXPECT_GT(along, 1e-9);
          sum += along;
        }
        EXPECT_NEAR(sum, twice_area, 1e-9 * twice_area);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, PolygonTest,
    testing::Values(Shape{"square", {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, PolygonCut::kFan},
                    Shape{"arrow", {{0, 0, 0}, {4, 0, 0}, {1, 1, 0}, {0, 4, 0}}, PolygonCut::kEars},
                    Shape{"house",
                          {{40, 30, 0}, {20, 10, 0}, {0, 30, 0}, {0, 0, 0}, {40, 0, 0}},
                          PolygonCut::kEars},
                    Shape{"hexagon",
                          {{2, 0, 0}, {1, 2, 0}, {-1, 2, 0}, {-2, 0, 0}, {-1, -2, 0}, {1, -2, 0}},
                          PolygonCut::kFan},
                    // Three corners on each side: a fan has triangles without area.
                    Shape{"sides_in_halves",
                          {{0, 0, 0},
                           {1, 0, 0},
                           {2, 0, 0},
                           {2, 1, 0},
                           {2, 2, 0},
                           {1, 2, 0},
                           {0, 2, 0},
                           {0, 1, 0}},
                          PolygonCut::kEars},
                    Shape{"triangle_with_more",
                          {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {0, 3, 0}},
                          PolygonCut::kEars},
                    Shape{"star", Star(7, 0.3), PolygonCut::kEars},
                    Shape{"comb", Comb(5), PolygonCut::kEars}),
    [](const auto& each) { return std::string(each.param.name); });

TEST(Polygon, AHoleReachedByAnEdgeStaysAHole) {
  // A square ring: out along 0–4, around the hole, and back.
  const std::vector<Point3> v{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0},
                              {1, 1, 0}, {1, 3, 0}, {3, 3, 0}, {3, 1, 0}};
  const std::vector<std::uint32_t> corners{0, 1, 2, 3, 0, 4, 5, 6, 7, 4};
  std::vector<Triangle> triangles;
  EXPECT_EQ(CutPolygon(v, corners, triangles), PolygonCut::kEars);
  ASSERT_EQ(triangles.size(), 8u);
  double sum = 0;
  for (const Triangle& t : triangles) {
    const double area = AreaOf(v, t)[2];
    EXPECT_GT(area, 0);
    sum += area;
  }
  EXPECT_NEAR(sum, 2 * (16 - 4), 1e-12);
}

TEST(Polygon, AFanBeginsAtTheFirstCorner) {
  const std::vector<Point3> v{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  std::vector<Triangle> triangles;
  EXPECT_EQ(CutPolygon(v, AllOf(v), triangles), PolygonCut::kFan);
  EXPECT_THAT(triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
}

TEST(Polygon, WhatHasNoRightCutIsAFanAndSaysSo) {
  const std::vector<std::vector<Point3>> shapes{
      {{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}},  // crosses itself
      {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}},  // a line
      {{5, 5, 5}, {5, 5, 5}, {5, 5, 5}, {5, 5, 5}},  // a point
  };
  for (const auto& v : shapes) {
    std::vector<Triangle> triangles;
    EXPECT_EQ(CutPolygon(v, AllOf(v), triangles), PolygonCut::kUnclear);
    EXPECT_THAT(triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
  }
}

TEST(Polygon, ConvexOnesMayHaveAnyNumberOfCorners) {
  const auto circle = [](std::size_t count) {
    std::vector<Point3> v;
    for (std::size_t i = 0; i < count; ++i) {
      const double angle =
          2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
      v.push_back({std::cos(angle), std::sin(angle), 0});
    }
    return v;
  };
  std::vector<Point3> v = circle(20000);
  std::vector<Triangle> triangles;
  EXPECT_EQ(CutPolygon(v, AllOf(v), triangles), PolygonCut::kFan);
  EXPECT_EQ(triangles.size(), v.size() - 2);
  v[5000] = {0.5, 0, 0};
  triangles.clear();
  EXPECT_EQ(CutPolygon(v, AllOf(v), triangles), PolygonCut::kTooLong);
  EXPECT_TRUE(triangles.empty());
}

}  // namespace
}  // namespace arap
