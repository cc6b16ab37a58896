// The loggers that a config asks for. Nothing here is global: main puts them in their places.
#pragma once

#include <memory>

#include <spdlog/logger.h>

#include "arap/base/result.h"
#include "server/config/config.h"

namespace arap::config {

struct Logs {
  std::shared_ptr<spdlog::logger> main;
  std::shared_ptr<spdlog::logger> access;  // null: RPCs go into the log
};

// kInvalidOption when a file cannot be opened.
Result<Logs> MakeLogs(const LogOptions& options);

}  // namespace arap::config
