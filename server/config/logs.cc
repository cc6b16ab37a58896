#include "server/config/logs.h"

#include <chrono>

#include <fmt/format.h>
#include <spdlog/sinks/null_sink.h>
#include <spdlog/sinks/rotating_file_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>

#include "server/rpc/rpc_log.h"

namespace arap::config {
namespace {

constexpr const char* kPattern = "%Y-%m-%dT%H:%M:%S.%e%z level=%l %v";
constexpr const char* kAccessPattern = "%Y-%m-%dT%H:%M:%S.%e%z %v";

// The library throws for a file that it cannot open.
Result<spdlog::sink_ptr> FileSink(const LogOptions& options, const char* flag,
                                  const std::string& path) {
  try {
    return std::make_shared<spdlog::sinks::rotating_file_sink_mt>(path, options.max_bytes,
                                                                  options.files);
  } catch (const spdlog::spdlog_ex& error) {
    return Fail(
        Fault(FaultKind::kInvalidOption, fmt::format("--{}: {}", flag, error.what())).Field(flag));
  }
}

}  // namespace

Result<Logs> MakeLogs(const LogOptions& options) {
  Logs logs;
  spdlog::sink_ptr sink;
  if (options.file.empty()) {
    sink = std::make_shared<spdlog::sinks::stderr_color_sink_mt>();
  } else {
    auto file = FileSink(options, "log-file", options.file);
    if (!file) return Fail(std::move(file.error()));
    sink = *file;
  }
  logs.main = std::make_shared<spdlog::logger>("arapd", sink);
  logs.main->set_pattern(kPattern);
  logs.main->set_level(spdlog::level::from_str(options.level));
  logs.main->flush_on(spdlog::level::info);
  if (options.access == "-") return logs;
  if (options.access == "off") {
    sink = std::make_shared<spdlog::sinks::null_sink_mt>();
  } else {
    auto file = FileSink(options, "access-log", options.access);
    if (!file) return Fail(std::move(file.error()));
    sink = *file;
  }
  logs.access = std::make_shared<spdlog::logger>(rpc::kAccessLog, sink);
  logs.access->set_pattern(kAccessPattern);
  logs.access->set_level(options.access == "off" ? spdlog::level::off : spdlog::level::info);
  logs.access->flush_on(spdlog::level::info);
  return logs;
}

}  // namespace arap::config
