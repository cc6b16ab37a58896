// Shapes as signed distance fields: negative inside, about the distance near the outline.
#pragma once

#include <functional>

#include "client/cli/sample/point.h"

namespace arap::cli {

using Field = std::function<double(Point)>;

// A disk, and a capsule whose radius goes from `radius_a` at `a` to `radius_b` at `b`.
double Disk(Point p, Point center, double radius);
double Capsule(Point p, Point a, Point b, double radius_a, double radius_b);
// An ellipse along the axes.
double Ellipse(Point p, Point center, double radius_x, double radius_y);

// The union of two fields with its inner corners rounded over about `blend`.
double SmoothUnion(double a, double b, double blend);

// By central differences over `step`.
Point Gradient(const Field& field, Point p, double step);
// Moves `p` along the gradient to the outline.
Point Project(const Field& field, Point p, double step);

}  // namespace arap::cli
