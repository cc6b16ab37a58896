// Answers: what a server sent, checked once against what was asked, as the values that the client
// library shows.
//
// Nothing of an answer is used before it was checked here, for a server may be broken, of another
// version or not ours at all. Faults: kInternal, with a sentence that says what does not fit.
// Numbers that only tell (times, counts of warnings, bytes) are taken as they are; every length,
// index, id and coordinate is checked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "arap/base/result.h"
#include "arap/client/client.h"
#include "core/base/mutex.h"

namespace google::protobuf {
template <typename Element>
class RepeatedField;
}
namespace arap::v1 {
class DeformOptions;
class FlattenRequest;
class FlattenResponse;
class GetServerInfoResponse;
class HandleSetInfo;
class ListSessionsResponse;
class MeshInfo;
class MeshOutlineResponse;
class Session;
class Shape;
}  // namespace arap::v1

namespace arap::client::internal {

struct MeshSize {
  std::size_t vertices = 0, triangles = 0;
};

// How large the meshes of a session are, as far as this side knows: because it has sent the mesh, or has
// asked for it. Shapes are checked against that. Thread-safe. Shared by the copies of a Session and their streams.
class KnownSizes {
 public:
  void Know(const std::string& mesh_id, MeshSize size);
  void Forget(const std::string& mesh_id);
  // Which mesh a handle set is on.
  void KnowSet(const std::string& handle_set_id, const std::string& mesh_id);
  void ForgetSet(const std::string& handle_set_id);
  // Nothing for a set or mesh that was never seen.
  std::optional<MeshSize> OfSet(const std::string& handle_set_id) const;
  std::optional<MeshSize> OfMesh(const std::string& mesh_id) const;

 private:
  mutable Mutex mutex_;
  std::map<std::string, MeshSize> meshes_ ABSL_GUARDED_BY(mutex_);
  std::map<std::string, std::string> sets_ ABSL_GUARDED_BY(mutex_);
};

// What a shape was asked to be.
struct ShapeQuestion {
  ShapeOptions options;
  std::optional<MeshSize> mesh = {};  // when it is known
  // As many as were asked; nothing when that is not known any more, but for the limit of picks.
  std::optional<std::size_t> picks = 0;
  // Whose positions; empty: of all. What VerticesFromWire has answered.
  std::vector<std::uint32_t> vertices = {};
  bool measured = true;  // whether it has to be
};
Result<Shape> FromWire(const v1::Shape& shape, const ShapeQuestion& asked);
void ToWire(const ShapeOptions& options, v1::DeformOptions* out);
// The vertices that an answer says its positions are of: those that were asked for, or none for all.
Result<std::vector<std::uint32_t>> VerticesFromWire(
    const google::protobuf::RepeatedField<std::uint32_t>& answered, const ShapeOptions& options,
    std::optional<MeshSize> mesh);

// `mesh_id` and `sent` are what was asked for; an empty id and no mesh stand for any.
Result<MeshInfo> FromWire(const v1::MeshInfo& mesh, const std::string& mesh_id,
                          const PlanarMesh* sent);

// Triangles of the plane that run counter-clockwise.
Result<OutlineMesh> FromWire(const v1::MeshOutlineResponse& response);

// The set has this id; `mesh_id` unless that is empty; and behind other handles those of `last`, or
// just those when `all`.
struct SetQuestion {
  std::string id;
  std::string mesh_id = {};
  std::span<const Handle> last = {};
  bool all = false;
};
Result<HandleSetInfo> FromWire(const v1::HandleSetInfo& set, const SetQuestion& asked,
                               std::optional<MeshSize> mesh);

// A session of that id, or of any when it is empty.
Result<SessionInfo> FromWire(const v1::Session& session, const std::string& id);
// At most `page_size` sessions (0: at most 1000) and another token than the one that was sent.
Result<SessionPage> FromWire(const v1::ListSessionsResponse& response, std::uint32_t page_size,
                             const std::string& page_token);
ServerInfo FromWire(const v1::GetServerInfoResponse& response);

// Of surfaces laid flat: flatten_answers.cc.
void ToWire(const SurfaceMesh& mesh, const FlattenQuery& query, v1::FlattenRequest* out);
// A layout of that mesh with all that was asked for, drawings too.
Result<FlatSurface> FromWire(const v1::FlattenResponse& response, const SurfaceMesh& mesh,
                             const FlattenQuery& query);

// A fault of that kind, for what streams, tracks and jobs check themselves.
Fault BadAnswer(std::string sentence);

}  // namespace arap::client::internal
