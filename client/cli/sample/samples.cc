#include "client/cli/sample/samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>

#include "client/cli/sample/field.h"
#include "core/base/plane.h"

namespace arap::cli {
namespace {

// Adds a handle that holds `mesh` at `rest`, a point inside it.
void AddHandle(const PlanarMesh& mesh, const std::string& name, Point rest, Track& track) {
  // The triangle in which the point lies deepest; the smallest weight says how deep.
  TriangleAnchor best;
  double depth = -std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto corner = [&](std::size_t k) { return mesh.vertices[mesh.triangles[t][k]]; };
    const Point a = corner(0), b = corner(1), c = corner(2);
    const double area = Cross(b - a, c - a);
    const std::array<double, 3> weights{Cross(b - rest, c - rest) / area,
                                        Cross(c - rest, a - rest) / area,
                                        Cross(a - rest, b - rest) / area};
    const double smallest = *std::min_element(weights.begin(), weights.end());
    if (smallest > depth) {
      depth = smallest;
      best = {static_cast<std::uint32_t>(t), weights};
    }
  }
  TrackHandle& added = track.handles.emplace_back();
  added.handle.id = name;
  added.handle.anchor = best;
  added.rest = rest;
}

// The bear.

// Mirrors the left half: p and its mirror image see the same field.
template <class Part>
double Both(Point p, Part part) {
  return std::min(part(p), part(Point(-p.real(), p.imag())));
}

double Bear(Point p) {
  const double head = Ellipse(p, {0, 152}, 36, 32);
  const double ears = Both(p, [](Point q) { return Disk(q, {27, 178}, 13); });
  const double trunk = Ellipse(p, {0, 84}, 35, 44);
  const double arms = Both(p, [](Point q) { return Capsule(q, {24, 108}, {72, 82}, 13, 15); });
  const auto leg = [](Point q) { return Capsule(q, {19, 58}, {31, 20}, 18, 20); };
  const double legs = SmoothUnion(leg(p), leg({-p.real(), p.imag()}), 10);

  double bear = SmoothUnion(trunk, head, 22);
  bear = SmoothUnion(bear, ears, 8);
  bear = SmoothUnion(bear, arms, 14);
  return SmoothUnion(bear, legs, 12);
}

// How it moves.

constexpr int kFrames = 120;
constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kDegree = std::numbers::pi / 180;

// 0 before `from`, 1 after `to`, smooth between.
double Ease(double t, double from, double to) {
  const double s = std::clamp((t - from) / (to - from), 0.0, 1.0);
  return s * s * (3 - 2 * s);
}

// Up from 0 to 1 and down again between `from` and `to`.
double Hop(double t, double from, double to) {
  const double s = std::clamp((t - from) / (to - from), 0.0, 1.0);
  return std::pow(std::sin(std::numbers::pi * s), 2);
}

Point Turned(Point p, Point about, double angle) {
  return about + std::polar(1.0, angle) * (p - about);
}

struct Joint {
  const char* name;
  Point rest;
  Point (*at)(Point rest, double t);  // t from 0 to 1
};

// The right hand goes up, waves three times and comes down; the head leans away from it.
Point RightHand(Point rest, double t) {
  const double raised = Ease(t, 0.04, 0.26) - Ease(t, 0.76, 0.97);
  const double waving = Ease(t, 0.22, 0.32) - Ease(t, 0.7, 0.8);
  const double wave = std::sin(kTurn * 4 * (t - 0.26));
  return Turned(rest, {26, 106}, (56 * raised + 17 * wave * waving) * kDegree);
}
Point LeftHand(Point rest, double t) {
  return Turned(rest, {-26, 106},
                (14 * std::sin(kTurn * t) + 6 * std::sin(2 * kTurn * t)) * kDegree);
}
Point Head(Point rest, double t) {
  const double lean = 9 * Hop(t, 0, 1) + 3 * std::sin(2 * kTurn * t);
  const double nod = std::cos(2 * kTurn * t) - 1;
  return Turned(rest, {0, 112}, lean * kDegree) + Point(0, 1.5 * nod);
}
Point LeftFoot(Point rest, double t) {
  const double hop = Hop(t, 0.1, 0.45);
  return rest + hop * Point(-10, 15);
}
Point RightFoot(Point rest, double t) {
  const double hop = Hop(t, 0.55, 0.9);
  return rest + hop * Point(12, 15);
}

constexpr std::array<Joint, 5> kJoints{{{"left_hand", {-72, 82}, &LeftHand},
                                        {"right_hand", {72, 82}, &RightHand},
                                        {"left_foot", {-31, 20}, &LeftFoot},
                                        {"right_foot", {31, 20}, &RightFoot},
                                        {"head", {0, 156}, &Head}}};

// The garment.

constexpr double kLength = 55;  // waist to hem
constexpr double kWaistRadius = 11.5;
constexpr double kHipBulge = 3.0;                       // round the hip, a quarter down
constexpr double kFlare = 9.0;                          // more radius at the hem
constexpr double kFoldDepth = 1.3;                      // of the folds at the hem
constexpr double kFolds = 4;                            // over the panel
constexpr double kHalfAngle = 0.46 * std::numbers::pi;  // a little less than the front half
constexpr double kWaistDip = 2.0;                       // the waistline drops towards the middle
constexpr double kDepthOverWidth = 0.8;                 // a body is wider than deep

// u from -1 (left seam) to 1 (right seam), v from 0 (hem) to 1 (waist).
Point3 Surface(double u, double v) {
  const double down = 1 - v;
  const double hip = kHipBulge * std::exp(-std::pow((down - 0.28) / 0.2, 2));
  const double folds = kFoldDepth * down * down * std::cos(kFolds * std::numbers::pi * u);
  const double radius = kWaistRadius + hip + kFlare * down + folds;
  const double angle = kHalfAngle * u;
  const double dip = kWaistDip * v * (1 - u * u);
  return {radius * std::sin(angle), v * kLength - dip, kDepthOverWidth * radius * std::cos(angle)};
}

// The face.

constexpr double kWidth = 6.5, kHeight = 9, kDepth = 6.5;  // half axes of the head
constexpr double kOpening = 88 * std::numbers::pi / 180;   // from the nose to the rim
constexpr double kDiskRadius = 10;                         // of the disk that is bent over it

// 1 at the middle, falling off over `width` and `height`.
double Bump(Point p, Point middle, double width, double height) {
  const Point d = p - middle;
  return std::exp(-std::pow(d.real() / width, 2) - std::pow(d.imag() / height, 2));
}

// How far the face stands out at a place that is seen from the front.
double Relief(Point p) {
  const Point half(std::abs(p.real()), p.imag());
  double z = 2.6 * Bump(p, {0, -1.0}, 1.3, 1.1) + 1.4 * Bump(p, {0, 0.9}, 1.0, 1.6);  // nose
  z += 0.7 * Bump(half, {1.2, -1.5}, 0.8, 0.7);                                       // its wings
  z += -1.6 * Bump(half, {2.7, 1.4}, 1.5, 1.2);                                       // eye sockets
  z += 1.0 * Bump(half, {2.7, 1.2}, 0.9, 0.7);                                        // eyes
  z += 0.8 * Bump(half, {2.4, 3.1}, 2.2, 0.8);                                        // brows
  z += 0.8 * Bump(half, {3.6, -1.5}, 1.3, 1.4);                                       // cheeks
  z += 1.0 * Bump(p, {0, -4.0}, 1.9, 0.7) - 0.8 * Bump(p, {0, -5.3}, 2.0, 0.6);       // lips
  return z + 1.3 * Bump(p, {0, -6.9}, 1.8, 1.2);                                      // chin
}

}  // namespace

PlanarMesh MakeCharacter(double edge) { return MeshField(Bear, {0, 190}, edge); }

Track MakeCharacterTrack(const PlanarMesh& mesh) {
  Track track;
  for (const Joint& joint : kJoints) AddHandle(mesh, joint.name, joint.rest, track);
  for (int i = 0; i < kFrames; ++i) {
    TrackFrame& frame = track.frames.emplace_back();
    frame.kind = i == 0 ? "rest" : "wave";
    for (const Joint& joint : kJoints) {
      frame.targets.push_back(
          {.position = Rounded(joint.at(joint.rest, static_cast<double>(i) / kFrames))});
    }
  }
  return track;
}

PlanarMesh MakeGrid(std::size_t columns, std::size_t rows) {
  PlanarMesh mesh;
  for (std::size_t y = 0; y < rows; ++y) {
    for (std::size_t x = 0; x < columns; ++x) {
      mesh.vertices.emplace_back(static_cast<double>(x), static_cast<double>(y));
    }
  }
  for (std::size_t y = 0; y + 1 < rows; ++y) {
    for (std::size_t x = 0; x + 1 < columns; ++x) {
      const auto a = static_cast<std::uint32_t>(y * columns + x);
      const std::uint32_t b = a + 1;
      const auto d = static_cast<std::uint32_t>(a + columns);
      const std::uint32_t c = d + 1;
      if ((x + y) % 2 == 0) {
        mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
      } else {
        mesh.triangles.insert(mesh.triangles.end(), {{a, b, d}, {b, c, d}});
      }
    }
  }
  return mesh;
}

Track MakeGridTrack(const PlanarMesh& mesh, std::size_t columns, std::size_t rows) {
  constexpr int kGridFrames = 60;
  constexpr double kLargestAngle = std::numbers::pi / 2;
  const double width = static_cast<double>(columns - 1);
  const double height = static_cast<double>(rows - 1);
  const Point middle(width / 2, height / 2);
  const std::array<Point, 4> corners{Point(width / 8, height / 8), Point(width * 7 / 8, height / 8),
                                     Point(width * 7 / 8, height * 7 / 8),
                                     Point(width / 8, height * 7 / 8)};
  Track track;
  constexpr std::array<const char*, 4> kNames{"lower_left", "lower_right", "upper_right",
                                              "upper_left"};
  for (std::size_t k = 0; k < corners.size(); ++k) AddHandle(mesh, kNames[k], corners[k], track);
  for (int i = 0; i < kGridFrames; ++i) {
    const double s = std::sin(std::numbers::pi * i / kGridFrames);
    const Point turn = std::polar(1.0, kLargestAngle * s * s);
    TrackFrame& frame = track.frames.emplace_back();
    frame.kind = i == 0 ? "rest" : "turn";
    for (const Point corner : corners) {
      const bool right = corner.real() > middle.real();
      frame.targets.push_back(
          {.position = right && i > 0 ? Rounded(middle + turn * (corner - middle)) : corner});
    }
  }
  return track;
}

SurfaceMesh MakeGarment(double edge) {
  constexpr double kMeanRadius = kWaistRadius + kFlare / 2 + 1;
  const auto columns = static_cast<std::size_t>(std::lround(2 * kHalfAngle * kMeanRadius / edge));
  const auto rows =
      static_cast<std::size_t>(std::lround(kLength / (edge * std::numbers::sqrt3 / 2)));
  SurfaceMesh mesh;
  for (std::size_t y = 0; y <= rows; ++y) {
    for (std::size_t x = 0; x <= columns; ++x) {
      // Every other row is shifted by half an edge, but not at the seams.
      const double shift = y % 2 == 1 && x > 0 && x < columns ? 0.25 : -0.25;
      const double inner = x > 0 && x < columns ? shift : 0;
      const double u = 2 * (static_cast<double>(x) + inner) / static_cast<double>(columns) - 1;
      Point3& p = mesh.vertices.emplace_back(
          Surface(u, static_cast<double>(y) / static_cast<double>(rows)));
      for (double& coordinate : p) coordinate = Rounded({coordinate, 0}).real();
    }
  }
  for (std::size_t y = 0; y < rows; ++y) {
    for (std::size_t x = 0; x < columns; ++x) {
      const auto a = static_cast<std::uint32_t>(y * (columns + 1) + x);
      const std::uint32_t b = a + 1;
      const auto d = static_cast<std::uint32_t>(a + columns + 1);
      const std::uint32_t c = d + 1;
      // The diagonal that the shift has made the shorter one.
      if (y % 2 == 0) {
        mesh.triangles.insert(mesh.triangles.end(), {{a, b, d}, {b, c, d}});
      } else {
        mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
      }
    }
  }
  return mesh;
}

SurfaceMesh MakeFace(double edge) {
  const PlanarMesh disk =
      MeshField([](Point p) { return Disk(p, 0, kDiskRadius); }, {kDiskRadius, 0}, edge);
  SurfaceMesh mesh;
  mesh.triangles = disk.triangles;
  for (const Point p : disk.vertices) {
    const double angle = std::abs(p) / kDiskRadius * kOpening;
    const Point toward = std::abs(p) > 0 ? p / std::abs(p) : 0;
    const Point front(kWidth * std::sin(angle) * toward.real(),
                      kHeight * std::sin(angle) * toward.imag());
    // The back of the rim has no features.
    const double z = kDepth * std::cos(angle) + std::max(0.0, std::cos(angle)) * Relief(front);
    const Point xy = Rounded(front);
    mesh.vertices.push_back({xy.real(), xy.imag(), Rounded({z, 0}).real()});
  }
  return mesh;
}

}  // namespace arap::cli
