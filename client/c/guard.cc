#include "client/c/guard.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <exception>
#include <stdexcept>
#include <string_view>

#include "core/base/names.h"

namespace {

// When to try again: what the server said, else what the kind says.
std::int64_t RetryOf(const arap::Fault& fault) {
  const std::string_view told = arap::DetailOf(fault, arap::kRetryDelayDetail);
  std::int64_t retry = arap::InfoOf(fault.kind).retry.count();
  std::from_chars(told.data(), told.data() + told.size(), retry);
  return retry;
}

}  // namespace

arap_error::arap_error(arap::Fault the_fault)
    : fault(std::move(the_fault)),
      reason(arap::InfoOf(fault.kind).reason),
      code(static_cast<std::int32_t>(arap::InfoOf(fault.kind).code)),
      retry_ms(RetryOf(fault)) {}

namespace arap::c {
namespace {

// Made when the library is loaded: when it is needed there is no memory to make it with.
arap_error* const kNoMemory =
    new arap_error(Fault(FaultKind::kOutOfMemory, "There is not enough memory for this."));

// What a clock can add to now: 30 years.
constexpr std::int64_t kLongest = std::int64_t{30} * 365 * 24 * 3600 * 1000;

}  // namespace

Fault Bad(std::string field, std::string message) {
  return Fault(FaultKind::kInvalidOption, std::move(message)).Field(std::move(field));
}

Fault BadChoice(std::string field, const char* what, std::int32_t number) {
  return Bad(std::move(field),
             std::string("There ") + what + " with the number " + std::to_string(number) + ".");
}

arap_error* NoMemory() noexcept { return kNoMemory; }

arap_error* ErrorOf(Fault&& fault) noexcept {
  try {
    return new arap_error(std::move(fault));
  } catch (...) {
    return kNoMemory;
  }
}

arap_error* ErrorOfException() noexcept {
  try {
    throw;
  } catch (const std::bad_alloc&) {
    return kNoMemory;
  } catch (const std::length_error&) {
    return kNoMemory;
  } catch (const std::exception& error) {
    try {
      return ErrorOf(Fault(FaultKind::kInternal, error.what()));
    } catch (...) {
      return kNoMemory;
    }
  } catch (...) {
    return ErrorOf(Fault(FaultKind::kInternal, "?"));
  }
}

Status Need(const void* pointer, const char* field) {
  if (pointer != nullptr) return {};
  return Fail(Bad(field, std::string(field) + " is NULL."));
}

Result<std::string> IdOf(const char* text, const char* field) {
  CHECK_OK(Need(text, field));
  std::string id = text;
  CHECK_OK(CheckName(id, field));
  return id;
}

Result<std::string> IdOrNone(const char* text, const char* field) {
  if (text == nullptr) return std::string();
  return IdOf(text, field);
}

std::string TextOf(const char* text) { return text == nullptr ? std::string() : std::string(text); }

std::chrono::milliseconds MillisOf(std::int64_t given, std::chrono::milliseconds standard,
                                   std::chrono::milliseconds never) {
  if (given == 0) return standard;
  if (given < 0) return never;
  return std::chrono::milliseconds(std::min(given, kLongest));
}

Result<client::CallOptions> CallOf(const arap_call_options* call) {
  TRY(const auto given, OptionsOf(call, "call"));
  client::CallOptions options;
  if (given.timeout_ms != 0) {
    options.timeout = MillisOf(given.timeout_ms, client::kNoLimit, client::kNoLimit);
  }
  options.retry_within =
      MillisOf(given.retry_ms, options.retry_within, std::chrono::milliseconds(0));
  return options;
}

Result<Basis> BasisOf(std::int32_t basis, Basis standard) {
  switch (basis) {
    case ARAP_BASIS_DEFAULT:
      return standard;
    case ARAP_BASIS_EDGE:
      return Basis::kEdge;
    case ARAP_BASIS_EDGE_AS_PUBLISHED:
      return Basis::kEdgeAsPublished;
    case ARAP_BASIS_FACE:
      return Basis::kFace;
    case ARAP_BASIS_VERTEX:
      return Basis::kVertex;
    default:
      return Fail(BadChoice("basis", "is no basis", basis));
  }
}

RepairOptions RepairsOf(const arap_repairs& repairs) {
  RepairOptions options;
  options.weld = repairs.weld != 0;
  options.drop_duplicates = repairs.drop_duplicates != 0;
  options.stitch = repairs.stitch != 0;
  if (repairs.tolerance != 0) options.tolerance = repairs.tolerance;
  return options;
}

Result<std::vector<Complex>> PointsOf(const double* values, std::size_t count, const char* field) {
  CHECK_OK(ArrayOf(values, count, field));
  std::vector<Complex> points(count);
  for (std::size_t i = 0; i < count; ++i) points[i] = {values[2 * i], values[2 * i + 1]};
  return points;
}

Result<std::vector<Triangle>> TrianglesOf(const std::uint32_t* values, std::size_t count) {
  CHECK_OK(ArrayOf(values, count, "triangles"));
  std::vector<Triangle> triangles(count);
  for (std::size_t i = 0; i < count; ++i) {
    triangles[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
  }
  return triangles;
}

std::vector<double> NumbersOf(const double* values, std::size_t count) {
  return values == nullptr ? std::vector<double>() : std::vector<double>(values, values + count);
}

}  // namespace arap::c

extern "C" {

const char* arap_version(void) { return ARAP_VERSION; }

const char* arap_error_reason(const arap_error* error) { return error->reason.c_str(); }
const char* arap_error_message(const arap_error* error) { return error->fault.message.c_str(); }
const char* arap_error_field(const arap_error* error) { return error->fault.field.c_str(); }
int32_t arap_error_code(const arap_error* error) { return error->code; }
int64_t arap_error_retry_ms(const arap_error* error) { return error->retry_ms; }

size_t arap_error_element_count(const arap_error* error) { return error->fault.elements.size(); }
const uint32_t* arap_error_elements(const arap_error* error) {
  return error->fault.elements.data();
}

const char* arap_error_detail(const arap_error* error, const char* name) {
  for (const auto& [known, value] : error->fault.details) {
    if (name != nullptr && known == name) return value.c_str();
  }
  return nullptr;
}
size_t arap_error_detail_count(const arap_error* error) { return error->fault.details.size(); }
const char* arap_error_detail_name(const arap_error* error, size_t index) {
  const auto& details = error->fault.details;
  return index < details.size() ? details[index].first.c_str() : nullptr;
}
const char* arap_error_detail_value(const arap_error* error, size_t index) {
  const auto& details = error->fault.details;
  return index < details.size() ? details[index].second.c_str() : nullptr;
}

void arap_error_free(arap_error* error) {
  if (error != arap::c::NoMemory()) delete error;
}

size_t arap_warning_count(const arap_warnings* warnings) { return warnings->all.size(); }
const char* arap_warning_kind(const arap_warnings* warnings, size_t index) {
  return index < warnings->all.size() ? warnings->all[index].kind.c_str() : nullptr;
}
const char* arap_warning_message(const arap_warnings* warnings, size_t index) {
  return index < warnings->all.size() ? warnings->all[index].message.c_str() : nullptr;
}
size_t arap_warning_elements(const arap_warnings* warnings, size_t index) {
  return index < warnings->all.size() ? warnings->all[index].count : 0;
}

}  // extern "C"
