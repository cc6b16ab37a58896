// What the server is and what it allows.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "arap/model/limits.h"

namespace arap::client {

using arap::Limits;

struct ServerInfo {
  std::string version;  // semantic version
  Limits limits;        // in force; a request beyond one fails with a fault that names it
  std::vector<std::string> capabilities;  // names such as "basis.edge"
  std::uint32_t workers = 0;              // worker threads
};

}  // namespace arap::client
