// Fault: what is wrong with the input or the request, as a value.
//
// A fault carries a kind (one name per thing that can go wrong), a sentence for people, the ids of
// the first offending elements and the numbers that the sentence mentions. The server maps every
// kind to one status code and one reason in a single exhaustive switch (server/rpc/status_map.cc).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace arap {

enum class FaultKind {
  // Meshes.
  kEmptyMesh,    // no vertices or no triangles
  kArrayLength,  // an array whose length breaks its rule (x y x y…, i j k…, one per triangle)
  kNonFiniteCoordinate,  // NaN or infinity in a vertex
  kIndexOutOfRange,      // a triangle names a vertex that is not there
  kRepeatedIndex,        // a triangle names the same vertex twice
  kDegenerateTriangle,   // a triangle of (relatively) zero area
  kDuplicateTriangle,    // two triangles on the same three vertices
  kNonManifoldEdge,      // an edge with three or more triangles
  kNonManifoldVertex,    // a vertex where parts of the surface touch in nothing else
  kNotOrientable,        // no consistent orientation exists
  kNotADisk,             // a surface to flatten that is not one disk
  kUnknownEdge,          // a seam that is no edge of the mesh
  kNotInjective,         // no layout without a flipped triangle was reached
  kMeshTooLarge,         // more vertices or triangles than the limit
  // Options.
  kInvalidOption,  // an option out of its range
  // Handles and targets.
  kHandleOutside,       // a handle position outside the mesh
  kDuplicateHandle,     // two handles with one id
  kUnknownHandle,       // an id that no handle has
  kConflictingHandles,  // hard handles whose targets cannot all be met
  kNonFiniteTarget,     // NaN or infinity in a target
  kTargetCount,         // a wrong number of targets
  kTooManyHandles,      // more handles than the limit
  // Names on the server.
  kInvalidName,    // an id of forbidden length or characters
  kNotFound,       // no such session, mesh or handle set
  kAlreadyExists,  // the id is taken by something else
  kProtocol,       // a stream message out of order
  // Resources.
  kLimitExceeded,     // a quota of the server
  kOverloaded,        // the work queue is full: try again
  kDraining,          // the server is going away: try another
  kCancelled,         // the caller gave up
  kDeadlineExceeded,  // the caller's deadline passed
  kStreamIdle,        // a stream on which nothing was said for too long
  // Who is asking.
  kUnauthenticated,   // no identity, or one that does not hold
  kPermissionDenied,  // an identity that may not do this
  // Where sessions are kept.
  kStoreUnavailable,  // the store does not answer or cannot write: try again
  kDataLoss,          // what was stored is missing or damaged
  // Ours.
  kUnimplemented,  // shaped, not yet filled
  kNumerical,      // a factorisation or a result that should have been finite is not
  kInternal,       // a bug
};

// Stable lower-case name of a kind, for logs and messages ("degenerate_triangle").
const char* FaultName(FaultKind kind);

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

  Fault& Element(std::uint32_t id) {
    if (elements.size() < kMaxElements) elements.push_back(id);
    return *this;
  }
  Fault& Detail(std::string name, std::string value) {
    details.emplace_back(std::move(name), std::move(value));
    return *this;
  }
  Fault& Field(std::string path) {
    field = std::move(path);
    return *this;
  }
};

}  // namespace arap
