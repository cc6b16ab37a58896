// What every function of the C interface goes through: faults and exceptions become an arap_error,
// options of any size become ours, pointers and ids are looked at before they are used.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "arap/base/result.h"
#include "arap/c/arap_c.h"
#include "arap/client/call.h"
#include "arap/client/mesh.h"
#include "core/base/try.h"

// NOLINTBEGIN(readability-identifier-naming): the names of C.
struct arap_error {
  explicit arap_error(arap::Fault the_fault);

  arap::Fault fault;
  std::string reason;
  std::int32_t code = 0;
  std::int64_t retry_ms = 0;
};

struct arap_warnings {
  std::vector<arap::Warning> all;
};
// NOLINTEND(readability-identifier-naming)

namespace arap::c {

// kInvalidOption with the parameter as the field.
Fault Bad(std::string field, std::string message);
// The same for a number that stands for nothing: BadChoice("mode", "is no mode", 7).
Fault BadChoice(std::string field, const char* what, std::int32_t number);

// The error of a fault; one that was made before where there is no memory for it.
arap_error* ErrorOf(Fault&& fault) noexcept;
arap_error* NoMemory() noexcept;
// The error of the exception that is being handled.
arap_error* ErrorOfException() noexcept;

// Runs the body of a function, a Status(). Whatever it throws is an error.
template <class Body>
arap_error* Guard(const Body& body) noexcept {
  try {
    Status status = body();
    return status ? nullptr : ErrorOf(std::move(status).error());
  } catch (...) {
    return ErrorOfException();
  }
}

// kInvalidOption for a pointer that has to be there.
Status Need(const void* pointer, const char* field);
// An id that has to be there and to be one: kInvalidOption, kInvalidName.
Result<std::string> IdOf(const char* text, const char* field);
// The same where NULL is allowed: an empty text.
Result<std::string> IdOrNone(const char* text, const char* field);
// An empty text for NULL.
std::string TextOf(const char* text);

// `count` values of an array, which may be NULL only when there are none.
template <class Value>
Result<std::span<const Value>> ArrayOf(const Value* values, std::size_t count, const char* field) {
  if (count == 0) return std::span<const Value>();
  CHECK_OK(Need(values, field));
  // Rows of at most three: beyond this no array can be.
  // NOLINTNEXTLINE(bugprone-sizeof-expression): pointers make an array too.
  if (count > PTRDIFF_MAX / (3 * sizeof(Value))) {
    return Fail(Bad(field, std::string(field) + " cannot have so many elements."));
  }
  return std::span(values, count);
}

// Options as this version knows them. kInvalidOption for a size that is none, and for members that
// this version does not know and that are not the default.
template <class Options>
Result<Options> OptionsOf(const Options* given, const char* field) {
  Options ours{};
  if (given == nullptr) return ours;
  if (given->size < sizeof(given->size)) {
    return Fail(Bad(std::string(field) + ".size", "The options do not say their size."));
  }
  const auto* bytes = reinterpret_cast<const unsigned char*>(given);
  for (std::size_t i = sizeof(Options); i < given->size; ++i) {
    if (bytes[i] == 0) continue;
    return Fail(Bad(field, "The options have members that this version does not know."));
  }
  std::memcpy(&ours, given, std::min(given->size, sizeof(Options)));
  return ours;
}

Result<client::CallOptions> CallOf(const arap_call_options* call);
// 0: nothing; below 0: `never`.
std::chrono::milliseconds MillisOf(std::int64_t given, std::chrono::milliseconds standard,
                                   std::chrono::milliseconds never);

Result<Basis> BasisOf(std::int32_t basis, Basis standard);
RepairOptions RepairsOf(const arap_repairs& repairs);
// n × 2 doubles.
Result<std::vector<Complex>> PointsOf(const double* values, std::size_t count, const char* field);
// n × 3 indices.
Result<std::vector<Triangle>> TrianglesOf(const std::uint32_t* values, std::size_t count);
// n doubles, or none for NULL.
std::vector<double> NumbersOf(const double* values, std::size_t count);

// Complex numbers as the doubles that they are.
inline const double* Doubles(const std::vector<Complex>& points) {
  return reinterpret_cast<const double*>(points.data());
}

}  // namespace arap::c
