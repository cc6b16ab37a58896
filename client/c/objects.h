// What is behind the pointers that C holds, and what sessions and streams both take from C.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "arap/client/client.h"
#include "client/c/guard.h"

// NOLINTBEGIN(readability-identifier-naming): the names of C.
struct arap_client {
  arap::client::Client client;
};

struct arap_session {
  arap::client::Session session;
};

struct arap_shape {
  arap::client::Shape shape;
};
// NOLINTEND(readability-identifier-naming)

namespace arap::c {

Result<std::vector<client::Handle>> HandlesOf(const arap_handle* handles, std::size_t count,
                                              const char* field);
Result<std::vector<client::HandleTarget>> TargetsOf(const arap_target* targets, std::size_t count);
Result<std::vector<std::string>> IdsOf(const char* const* ids, std::size_t count,
                                       const char* field);
// Of arap_shape_options and arap_stream_options, which have the same members.
template <class Options>
Result<client::ShapeOptions> ShapeOptionsOf(const Options& given) {
  client::ShapeOptions options;
  switch (given.mode) {
    case ARAP_MODE_DEFAULT:
    case ARAP_MODE_RIGID:
      break;
    case ARAP_MODE_SIMILARITY:
      options.deform.mode = client::DeformMode::kSimilarity;
      break;
    case ARAP_MODE_BASELINE:
      options.deform.mode = client::DeformMode::kBaseline;
      break;
    default:
      return Fail(
          Bad("mode", "There is no mode with the number " + std::to_string(given.mode) + "."));
  }
  if (given.refine < 0) return Fail(Bad("refine", "refine is below 0."));
  options.deform.refine = given.refine;
  options.float64 = given.float64 != 0;
  options.flipped_ids = given.flipped_ids != 0;
  return options;
}

}  // namespace arap::c
