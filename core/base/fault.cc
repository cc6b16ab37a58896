#include "arap/base/fault.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace arap {
namespace {

using std::chrono::milliseconds;
using enum FaultKind;

constexpr milliseconds kNever{0};
constexpr milliseconds kQuotaRetry{1000};
constexpr milliseconds kQueueRetry{50};
constexpr milliseconds kDrainRetry{200};
constexpr milliseconds kStoreRetry{500};

constexpr StatusCode kInvalid = StatusCode::kInvalidArgument;
constexpr StatusCode kMissing = StatusCode::kNotFound;
constexpr StatusCode kUnmet = StatusCode::kFailedPrecondition;
constexpr StatusCode kExhausted = StatusCode::kResourceExhausted;
constexpr StatusCode kGone = StatusCode::kUnavailable;

constexpr FaultInfo kTable[] = {
    {kEmptyMesh, "EMPTY_MESH", kInvalid, kNever, "no vertices or no triangles"},
    {kArrayLength, "ARRAY_LENGTH", kInvalid, kNever,
     "an array whose length breaks its rule (x y x y…, i j k…, one per triangle)"},
    {kNonFiniteCoordinate, "NON_FINITE_COORDINATE", kInvalid, kNever,
     "NaN or infinity in a vertex"},
    {kIndexOutOfRange, "INDEX_OUT_OF_RANGE", kInvalid, kNever,
     "a triangle names a vertex that is not there"},
    {kRepeatedIndex, "REPEATED_INDEX", kInvalid, kNever, "a triangle names the same vertex twice"},
    {kDegenerateTriangle, "DEGENERATE_TRIANGLE", kInvalid, kNever,
     "a triangle of (relatively) zero area"},
    {kDuplicateTriangle, "DUPLICATE_TRIANGLE", kInvalid, kNever,
     "two triangles on the same three vertices"},
    {kNonManifoldEdge, "NON_MANIFOLD_EDGE", kInvalid, kNever,
     "an edge with three or more triangles"},
    {kNonManifoldVertex, "NON_MANIFOLD_VERTEX", kInvalid, kNever,
     "a vertex where parts of the surface touch in nothing else"},
    {kNotOrientable, "NOT_ORIENTABLE", kInvalid, kNever, "no consistent orientation exists"},
    {kNotADisk, "NOT_A_DISK", kInvalid, kNever, "a surface to flatten that is not one disk"},
    {kUnknownEdge, "UNKNOWN_EDGE", kInvalid, kNever, "a seam that is no edge of the mesh"},
    {kNotInjective, "NOT_INJECTIVE", kUnmet, kNever,
     "no layout without a flipped triangle was reached"},
    {kMeshTooLarge, "MESH_TOO_LARGE", kExhausted, kLimitRetry,
     "more vertices or triangles than the limit"},
    {kInvalidOption, "INVALID_OPTION", kInvalid, kNever, "an option out of its range"},
    {kHandleOutside, "HANDLE_OUTSIDE", kInvalid, kNever, "a handle position outside the mesh"},
    {kDuplicateHandle, "DUPLICATE_HANDLE", kInvalid, kNever, "two handles with one id"},
    {kUnknownHandle, "UNKNOWN_HANDLE", kMissing, kNever, "an id that no handle has"},
    {kConflictingHandles, "CONFLICTING_HANDLES", kInvalid, kNever,
     "hard handles whose targets cannot all be met"},
    {kNonFiniteTarget, "NON_FINITE_TARGET", kInvalid, kNever, "NaN or infinity in a target"},
    {kTargetCount, "TARGET_COUNT", kInvalid, kNever, "a wrong number of targets"},
    {kTooManyHandles, "TOO_MANY_HANDLES", kExhausted, kLimitRetry, "more handles than the limit"},
    {kInvalidName, "INVALID_NAME", kInvalid, kNever, "an id of forbidden length or characters"},
    {kNotFound, "NOT_FOUND", kMissing, kNever, "no such session, mesh or handle set"},
    {kAlreadyExists, "ALREADY_EXISTS", StatusCode::kAlreadyExists, kNever,
     "the id is taken by something else"},
    {kProtocol, "PROTOCOL", kUnmet, kNever, "a stream message out of order"},
    {kLimitExceeded, "LIMIT_EXCEEDED", kExhausted, kQuotaRetry, "a quota of the server"},
    {kOutOfMemory, "OUT_OF_MEMORY", kExhausted, kQuotaRetry,
     "the machine had no memory for the work, which was undone"},
    {kOverloaded, "OVERLOADED", kExhausted, kQueueRetry, "the work queue is full: try again"},
    {kDraining, "DRAINING", kGone, kDrainRetry, "the server is going away: try another"},
    {kCancelled, "CANCELLED", StatusCode::kCancelled, kNever, "the caller gave up"},
    {kDeadlineExceeded, "DEADLINE_EXCEEDED", StatusCode::kDeadlineExceeded, kNever,
     "the caller's deadline passed"},
    {kStreamIdle, "STREAM_IDLE", StatusCode::kAborted, kNever,
     "a stream on which nothing was said for too long"},
    {kUnauthenticated, "UNAUTHENTICATED", StatusCode::kUnauthenticated, kNever,
     "no identity, or one that does not hold"},
    {kPermissionDenied, "PERMISSION_DENIED", StatusCode::kPermissionDenied, kNever,
     "an identity that may not do this"},
    {kStoreUnavailable, "STORE_UNAVAILABLE", kGone, kStoreRetry,
     "the store does not answer or cannot write: try again"},
    {kDataLoss, "DATA_LOSS", StatusCode::kDataLoss, kNever,
     "what was stored is missing or damaged"},
    {kUnimplemented, "UNIMPLEMENTED", StatusCode::kUnimplemented, kNever,
     "in the interface, not implemented yet"},
    {kNumerical, "NUMERICAL", StatusCode::kInternal, kNever,
     "a factorisation or a result that should have been finite is not"},
    {kInternal, "INTERNAL", StatusCode::kInternal, kNever, "a bug"},
};

constexpr bool InOrder() {
  for (std::size_t i = 0; i < std::size(kTable); ++i) {
    if (kTable[i].kind != static_cast<FaultKind>(i)) return false;
  }
  return std::size(kTable) == static_cast<std::size_t>(kInternal) + 1;
}
static_assert(InOrder(), "every kind has its line, at its place");

constexpr std::array<std::string_view, 17> kCodeNames = {
    "OK",
    "CANCELLED",
    "UNKNOWN",
    "INVALID_ARGUMENT",
    "DEADLINE_EXCEEDED",
    "NOT_FOUND",
    "ALREADY_EXISTS",
    "PERMISSION_DENIED",
    "RESOURCE_EXHAUSTED",
    "FAILED_PRECONDITION",
    "ABORTED",
    "OUT_OF_RANGE",
    "UNIMPLEMENTED",
    "INTERNAL",
    "UNAVAILABLE",
    "DATA_LOSS",
    "UNAUTHENTICATED",
};

}  // namespace

std::string_view CodeName(int code) {
  const auto index = static_cast<std::size_t>(code);
  return kCodeNames[code >= 0 && index < kCodeNames.size() ? index : 2];
}

std::span<const FaultInfo> FaultTable() { return kTable; }

const FaultInfo& InfoOf(FaultKind kind) { return kTable[static_cast<std::size_t>(kind)]; }

std::optional<FaultKind> KindOfReason(std::string_view reason) {
  const auto found = std::find_if(std::begin(kTable), std::end(kTable),
                                  [&](const FaultInfo& info) { return info.reason == reason; });
  if (found == std::end(kTable)) return std::nullopt;
  return found->kind;
}

std::string FaultName(FaultKind kind) {
  std::string name(InfoOf(kind).reason);
  for (char& c : name) c = static_cast<char>(c == '_' ? c : c - 'A' + 'a');
  return name;
}

std::string_view DetailOf(const Fault& fault, std::string_view name) {
  for (const auto& [key, value] : fault.details) {
    if (key == name) return value;
  }
  return {};
}

Fault& Fault::Detail(std::string name, double value) & {
  return Detail(std::move(name), fmt::format("{}", value));
}

}  // namespace arap
