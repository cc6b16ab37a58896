// The loggers that a config asks for. Nothing here is global: main puts them in their places.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include <spdlog/logger.h>

#include "arap/base/result.h"

namespace arap::config {

struct LogOptions {
  std::string level = "info";
  std::string file;  // empty: standard error
  std::size_t max_bytes = std::size_t{64} << 20u;
  std::size_t files = 5;     // rotated ones, beside the one that is written
  std::string access = "-";  // "-": into the log; "off"; else a file of its own
};

struct Logs {
  std::shared_ptr<spdlog::logger> main;
  std::shared_ptr<spdlog::logger> access;  // null: RPCs go into the log
};

// kInvalidOption when a file cannot be opened.
Result<Logs> MakeLogs(const LogOptions& options);

}  // namespace arap::config
