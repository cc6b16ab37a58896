// Fault: what is wrong with the input or the request, as a value.
//
// A fault carries a kind (one name per thing that can go wrong), a sentence for people, the ids of
// the first offending elements and the numbers that the sentence mentions. One table says for every
// kind what it is called, which status it becomes on the wire and when to try again (later where the
// fault names a field, see proto/convert/status.cc); server, client and docs/protocol.md go by it.
#pragma once

#include <chrono>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace arap {

// In the order of the table in fault.cc, which has a line of meaning for each.
enum class FaultKind : std::uint8_t {
  // Meshes.
  kEmptyMesh,
  kArrayLength,
  kNonFiniteCoordinate,
  kIndexOutOfRange,
  kRepeatedIndex,
  kDegenerateTriangle,
  kDuplicateTriangle,
  kNonManifoldEdge,
  kNonManifoldVertex,
  kNotOrientable,
  kNotADisk,
  kUnknownEdge,
  kNotInjective,
  kMeshTooLarge,
  // Options.
  kInvalidOption,
  // Handles and targets.
  kHandleOutside,
  kDuplicateHandle,
  kUnknownHandle,
  kConflictingHandles,
  kNonFiniteTarget,
  kTargetCount,
  kTooManyHandles,
  // Names on the server.
  kInvalidName,
  kNotFound,
  kAlreadyExists,
  kProtocol,
  // Resources.
  kLimitExceeded,
  kOutOfMemory,
  kOverloaded,
  kDraining,
  kCancelled,
  kDeadlineExceeded,
  kStreamIdle,
  // Who is asking.
  kUnauthenticated,
  kPermissionDenied,
  // Where sessions are kept.
  kStoreUnavailable,
  kDataLoss,
  // Ours.
  kUnimplemented,
  kNumerical,
  kInternal,
};

// The canonical status codes of RPCs, by their numbers on the wire.
enum class StatusCode : std::uint8_t {
  kOk = 0,
  kCancelled = 1,
  kUnknown = 2,
  kInvalidArgument = 3,
  kDeadlineExceeded = 4,
  kNotFound = 5,
  kAlreadyExists = 6,
  kPermissionDenied = 7,
  kResourceExhausted = 8,
  kFailedPrecondition = 9,
  kAborted = 10,
  kOutOfRange = 11,
  kUnimplemented = 12,
  kInternal = 13,
  kUnavailable = 14,
  kDataLoss = 15,
  kUnauthenticated = 16,
};

// "INVALID_ARGUMENT". kUnknown's for a number that is none of these.
std::string_view CodeName(int code);

// A line of the table of kinds.
struct FaultInfo {
  FaultKind kind;
  std::string_view reason;  // on the wire, without the prefix ERROR_REASON_: "EMPTY_MESH"
  StatusCode code;
  std::chrono::milliseconds retry;  // when to try again; 0: the same request fails again
  std::string_view meaning;         // one line, for people
};

// All kinds, in the order of FaultKind.
std::span<const FaultInfo> FaultTable();
const FaultInfo& InfoOf(FaultKind kind);
// The kind of a reason; nothing for one of a newer version.
std::optional<FaultKind> KindOfReason(std::string_view reason);

// The reason in lower case, for logs and messages ("degenerate_triangle").
std::string FaultName(FaultKind kind);

// A fault that came from a server has these details too. The canonical code of its status, as its
// upper-case name ("UNAVAILABLE"):
inline constexpr std::string_view kGrpcCodeDetail = "grpc_code";
// The milliseconds to wait before trying again, when the server gave a time:
inline constexpr std::string_view kRetryDelayDetail = "retry_delay_ms";

// A request beyond a limit is refused until somebody raises the limit.
inline constexpr std::chrono::milliseconds kLimitRetry = std::chrono::hours(1);

// Fault(FaultKind::kIndexOutOfRange, "…").Field("triangles").Element(7).Detail("limit", 5)
struct Fault {
  FaultKind kind = FaultKind::kInternal;
  // One plain sentence that names the element and the limit.
  std::string message;
  // Ids of the first offending elements (triangles, vertices or handles), at most kMaxElements.
  std::vector<std::uint32_t> elements;
  // The values that the message mentions, by name ("limit" → "200000").
  std::vector<std::pair<std::string, std::string>> details;
  // The request field at fault, in proto spelling ("triangles", "handles[3].weight"), or empty.
  std::string field;

  static constexpr std::size_t kMaxElements = 16;

  Fault() = default;
  Fault(FaultKind the_kind, std::string sentence) : kind(the_kind), message(std::move(sentence)) {}

  Fault& Element(std::uint32_t id) & {
    if (elements.size() < kMaxElements) elements.push_back(id);
    return *this;
  }
  Fault& Elements(std::span<const std::uint32_t> ids) & {
    for (const std::uint32_t id : ids) Element(id);
    return *this;
  }
  Fault& Elements(std::initializer_list<std::uint32_t> ids) & {
    return Elements(std::span(ids.begin(), ids.size()));
  }
  Fault& Detail(std::string name, std::string value) & {
    details.emplace_back(std::move(name), std::move(value));
    return *this;
  }
  Fault& Detail(std::string name, std::integral auto value) & {
    return Detail(std::move(name), std::to_string(value));
  }
  // The shortest digits that read back exactly.
  Fault& Detail(std::string name, double value) &;
  Fault& Field(std::string path) & {
    field = std::move(path);
    return *this;
  }

  // The same for a fault that is being made.
  Fault&& Element(std::uint32_t id) && { return std::move(Element(id)); }
  Fault&& Elements(std::span<const std::uint32_t> ids) && { return std::move(Elements(ids)); }
  Fault&& Elements(std::initializer_list<std::uint32_t> ids) && { return std::move(Elements(ids)); }
  template <class Value>
  Fault&& Detail(std::string name, Value&& value) && {
    return std::move(Detail(std::move(name), std::forward<Value>(value)));
  }
  Fault&& Field(std::string path) && { return std::move(Field(std::move(path))); }

  bool operator==(const Fault&) const = default;
};

// The detail of that name, or empty. The view lives as long as the fault.
std::string_view DetailOf(const Fault& fault, std::string_view name);

}  // namespace arap
