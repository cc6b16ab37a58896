#include "client/cli/sample/character.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "client/cli/sample/field.h"
#include "client/cli/sample/mesher.h"
#include "client/cli/sample/place_handle.h"

namespace arap::cli {
namespace {

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

}  // namespace arap::cli
