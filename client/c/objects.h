// What is behind the pointers that C holds, and what sessions, shapes and streams take from C.
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

// "handles[3].id".
inline std::string Member(const char* field, std::size_t index, const char* member) {
  return std::string(field) + "[" + std::to_string(index) + "]." + member;
}

Result<std::vector<client::Handle>> HandlesOf(const arap_handle* handles, std::size_t count,
                                              const char* field);
Result<std::vector<client::HandleTarget>> TargetsOf(const arap_target* targets, std::size_t count);
Result<std::vector<std::string>> IdsOf(const char* const* ids, std::size_t count,
                                       const char* field);
Result<client::ShapeOptions> ShapeOptionsOf(const arap_shape_options* options, const char* field);

}  // namespace arap::c
