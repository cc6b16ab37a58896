#include "client/cli/sample/character.h"

#include <algorithm>

#include "client/cli/sample/field.h"
#include "client/cli/sample/mesher.h"

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

}  // namespace

PlanarMesh MakeCharacter(double edge) { return MeshField(Bear, {0, 190}, edge); }

}  // namespace arap::cli
