// Flattening of surfaces: what to ask for, what comes back, and jobs of it that go on by
// themselves.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "arap/client/mesh.h"
#include "arap/model/drawing.h"
#include "arap/model/flatten.h"

namespace arap::client {

using arap::AbfOptions;
using arap::ArapOptions;
using arap::Corners;
using arap::Distortion;
using arap::Drawing;
using arap::DrawingFile;
using arap::DrawingFormat;
using arap::DrawingOptions;
using arap::FirstStepOptions;
using arap::FlatChart;
using arap::FlattenAnchors;
using arap::Flattening;
using arap::FlattenMethod;
using arap::FlattenOptions;
using arap::GrainLine;
using arap::LscmOptions;
using arap::NamedPart;
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
  // Also answer these drawings, at most kMaxDrawings. A server of before them answers kInternal.
  std::vector<DrawingOptions> drawings = {};
  // What the pieces of drawings are called: as the part that most of their triangles are of.
  std::vector<NamedPart> parts = {};
};

// The answer to Flatten.
struct FlatSurface {
  // first_step and singular_values when asked, `times` never. Indices are as the server sent them.
  Flattening flat;
  std::vector<Drawing> drawings;  // one for each that was asked for, in their order
  bool surface_cached = false;    // the server had the surface under surface_key
  double queue_micros = 0;        // time spent waiting for a worker
  double solve_micros = 0;        // time spent computing
};

enum class JobState {
  kWaiting,
  kRunning,
  kDone,
  kFailed,  // GetResult says why
  kCancelled,
};

// How a job stands.
struct FlattenJob {
  std::string id;
  JobState state = JobState::kWaiting;
  std::string phase;            // while it runs: "layout", "drawing", "storing"…
  double fraction = 0;          // of the work, an estimate until it is 1; falls only when a server
                                // that was started anew begins the job again
  std::uint32_t place = 0;      // how many jobs start before it, while it waits
  double expected_seconds = 0;  // until it ends
  std::uint64_t result_bytes = 0;  // when it is done

  bool ended() const { return state != JobState::kWaiting && state != JobState::kRunning; }
};

// Told how a job stands. Return false to stop watching; the job goes on.
using JobCallback = std::function<bool(const FlattenJob& job)>;

}  // namespace arap::client
