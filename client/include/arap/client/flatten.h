// Flattening of surfaces: what to ask for and what comes back.
#pragma once

#include <string>

#include "arap/client/mesh.h"
#include "arap/model/flatten.h"

namespace arap::client {

using arap::AbfOptions;
using arap::ArapOptions;
using arap::Distortion;
using arap::FirstStepOptions;
using arap::FlatChart;
using arap::FlattenAnchors;
using arap::Flattening;
using arap::FlattenMethod;
using arap::FlattenOptions;
using arap::GrainLine;
using arap::LscmOptions;
using arap::UvPin;

// How to flatten, and how to answer.
struct FlattenQuery {
  // Begin with the preset of a method. Refinements that are the preset's own are a wish: a server
  // that allows fewer takes those. Basis::kVertex is not for surfaces (kInvalidOption); a layout
  // that has to be injective and cannot be is kNotInjective.
  FlattenOptions options = ArapOptions();
  // The server keeps the prepared surface under this name for a while, 1 to 128 characters of
  // [A-Za-z0-9._-]; asking again with the same name, surface and cuts is faster. Empty: it does
  // not.
  std::string surface_key = {};
  bool first_step = false;       // also answer the result of the first step
  bool singular_values = false;  // also answer s1 and s2 of every triangle
  bool float64 = false;          // uv in double precision on the wire, else in single
};

// The answer to Flatten.
struct FlatSurface {
  // first_step and singular_values when asked, `times` never. Indices are as the server sent them.
  Flattening flat;
  bool surface_cached = false;  // the server had the surface under surface_key
  double queue_micros = 0;      // time spent waiting for a worker
  double solve_micros = 0;      // time spent computing
};

}  // namespace arap::client
