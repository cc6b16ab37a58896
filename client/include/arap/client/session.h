// Session: a namespace of meshes, handle sets and jobs on the server, which expires when unused.
//
// A Session is a value that names the session; copies name the same one, and dropping it leaves the
// session on the server. All members may be called from any thread at the same time. Every call
// sends the id as the header "x-session-id", by which a load balancer finds the replica.
//
// Copies remember together the sizes of the meshes that they have registered or got, and every
// shape must have as many vertices as its mesh. Of a mesh that they have never seen (another
// program has registered it) shapes may be of any size: GetMesh first, or compare it yourself.
//
// RegisterMesh, CompileHandles, EditHandles, Deform and SubmitFlatten take kWorkLimit at most,
// unless CallOptions say otherwise; WatchJob and GetResult as long as the server tells something
// every kQuickLimit; everything else kQuickLimit. call.h says which are made again when they are
// lost.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "arap/client/call.h"
#include "arap/client/deform_stream.h"
#include "arap/client/flatten.h"
#include "arap/client/handles.h"
#include "arap/client/mesh.h"
#include "arap/client/shape.h"

namespace arap::client {

namespace internal {
class Channel;
class KnownSizes;
}  // namespace internal

struct SessionInfo {
  std::string id;
  std::chrono::system_clock::time_point create_time;
  std::chrono::system_clock::time_point expire_time;  // unless it is used before
  std::chrono::nanoseconds ttl{0};                    // life without use
  std::map<std::string, std::string> labels;
  std::vector<std::string> mesh_ids;
  std::vector<std::string> handle_set_ids;
};

class Session {
 public:
  // Receives the frames of a track in order. Return false to stop: the call answers kCancelled.
  using FrameCallback = std::function<bool(Shape&& shape)>;

  const std::string& id() const { return id_; }

  // Does not extend the session's life.
  Result<SessionInfo> Get(const CallOptions& call = {}) const;
  // Ends the session; its open streams end with kNotFound.
  Status Delete(const CallOptions& call = {}) const;

  // Mends, validates and factors a mesh. An empty `mesh_id` means one made of the content hash.
  Result<Registration> RegisterMesh(const PlanarMesh& mesh, const EnergyOptions& energy,
                                    const std::string& mesh_id = {}, const CallOptions& call = {},
                                    const RepairOptions& repairs = {}) const;
  Result<MeshInfo> GetMesh(const std::string& mesh_id, const CallOptions& call = {}) const;
  // Forgets a mesh and the handle sets on it.
  Status DeleteMesh(const std::string& mesh_id, const CallOptions& call = {}) const;

  Result<Compilation> CompileHandles(const std::string& handle_set_id, const std::string& mesh_id,
                                     std::span<const Handle> handles,
                                     const CallOptions& call = {}) const;
  // Removes first, then adds. Nothing changes when it fails.
  Result<Compilation> EditHandles(const std::string& handle_set_id,
                                  std::span<const std::string> remove, std::span<const Handle> add,
                                  const CallOptions& call = {}) const;
  Result<HandleSetInfo> GetHandleSet(const std::string& handle_set_id,
                                     const CallOptions& call = {}) const;
  Status DeleteHandleSet(const std::string& handle_set_id, const CallOptions& call = {}) const;

  // One target for every handle of the set, in any order. `pick_points` are deformed points, at
  // most 1024, to map back to rest.
  Result<Shape> Deform(const std::string& handle_set_id, std::span<const HandleTarget> targets,
                       const ShapeOptions& options = {}, std::span<const Complex> pick_points = {},
                       const CallOptions& call = {}) const;

  // A whole track: a target per handle in every frame, in the order of `handle_ids`, which names
  // every handle of the set once. `on_frame` runs on the calling thread, once per frame and in
  // their order, and never for more frames than were asked for; a server that ends early is
  // kInternal. A frame that takes longer than kWorkLimit ends the track with kDeadlineExceeded.
  Status DeformTrack(const std::string& handle_set_id, std::span<const std::string> handle_ids,
                     std::span<const std::vector<Target>> frames, const ShapeOptions& options,
                     const FrameCallback& on_frame, const CallOptions& call = {}) const;

  // Begins a flattening that goes on by itself, also when the server is started anew. The job lives
  // as long as the session; submitting it again with the same arguments is harmless. kAlreadyExists
  // when the name has another request.
  Result<FlattenJob> SubmitFlatten(const std::string& job_id, const SurfaceMesh& mesh,
                                   const FlattenQuery& query = {},
                                   const CallOptions& call = {}) const;
  // Blocks until the job has ended and answers how; `on_change` runs on the calling thread, at
  // once, when something has changed and every second or so. kCancelled when it stops watching.
  Result<FlattenJob> WatchJob(const std::string& job_id, const JobCallback& on_change = {},
                              const CallOptions& call = {}) const;
  // The result of a job that is done, of any size; `mesh` and `query` are what was submitted, and
  // the result must fit them. kProtocol while it is not done; the fault of one that failed.
  Result<FlatSurface> GetResult(const std::string& job_id, const SurfaceMesh& mesh,
                                const FlattenQuery& query = {}, const CallOptions& call = {}) const;
  // Ends a job that is not done; one that has ended stays as it is.
  Result<FlattenJob> CancelJob(const std::string& job_id, const CallOptions& call = {}) const;

  // Opens a live stream and waits until the server has opened it. The timeout of `call` is that of
  // the whole stream.
  Result<DeformStream> OpenStream(const std::string& handle_set_id,
                                  const StreamOptions& options = {},
                                  const CallOptions& call = {}) const;

 private:
  friend class Client;
  Session(std::shared_ptr<internal::Channel> channel, std::string id);

  std::shared_ptr<internal::Channel> channel_;
  std::string id_;
  std::shared_ptr<internal::KnownSizes> sizes_;
};

}  // namespace arap::client
