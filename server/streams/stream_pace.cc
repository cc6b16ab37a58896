#include "server/streams/stream_pace.h"

namespace arap::app {
namespace {

// Measured with script/bench (docs/operations.md), rounded up.
constexpr double kFrameSeconds = 5e-5;
constexpr double kVertexSeconds = 1.5e-7;

}  // namespace

double FrameSeconds(std::size_t vertices, std::size_t refine) {
  return kFrameSeconds +
         kVertexSeconds * static_cast<double>(vertices) * static_cast<double>(1 + refine);
}

}  // namespace arap::app
