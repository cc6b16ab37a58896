// Session: a namespace of meshes and handle sets that ends when it is deleted or unused for too
// long.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/deform/compiled_handles.h"
#include "core/deform/registered_mesh.h"
#include "server/app/limits.h"
#include "server/runtime/clock.h"

namespace arap::app {

// What a client asks for when it opens a session. Equal specs make CreateSession harmless to
// repeat.
struct SessionSpec {
  std::string id;
  std::chrono::milliseconds ttl{};  // how long it lives without use
  std::map<std::string, std::string> labels;

  bool operator==(const SessionSpec&) const = default;
};

// A mesh under the id that the client gave it.
struct MeshEntry {
  std::string mesh_id;
  std::string content_hash;
  std::shared_ptr<const RegisteredMesh> mesh;
};

// A handle set under the id that the client gave it.
struct HandleSetEntry {
  std::string handle_set_id;
  std::string mesh_id;
  std::vector<Handle> definitions;  // as the client gave them, after the edits so far
  std::shared_ptr<const CompiledHandles> handles;
  std::uint64_t revision = 1;  // grows by one with every edit
};

// What a session looked like at one moment.
struct SessionView {
  SessionSpec spec;
  runtime::Clock::Wall created;
  runtime::Clock::Wall expires;
  std::vector<std::string> mesh_ids;        // ascending
  std::vector<std::string> handle_set_ids;  // ascending
};

// Thread-safe. Finding copies shared pointers under a short lock: deleting never pulls memory from
// running work.
class Session {
 public:
  using Listener = std::function<void()>;

  // `clock` outlives the session.
  Session(SessionSpec spec, const runtime::Clock& clock);

  const SessionSpec& spec() const { return spec_; }
  SessionView View() const;

  // Extends the life by a ttl from now. kNotFound when it has ended or expired.
  Status Touch();
  bool expired() const;

  // Ends the session: forgets everything, refuses additions, calls the listeners once, in this
  // thread.
  void End();
  // Calls `listener` when the session ends; at once if it has. It must not call back into the
  // session.
  std::uint64_t AddEndListener(Listener listener);
  void RemoveEndListener(std::uint64_t id);

  // The mesh under this id. kNotFound.
  Result<MeshEntry> FindMesh(const std::string& mesh_id) const;
  // Asks whether a mesh may be added: the entry when the same mesh is there, nothing when there is
  // room. kAlreadyExists for another mesh, kLimitExceeded.
  Result<std::optional<MeshEntry>> OfferMesh(const std::string& mesh_id, const std::string& hash,
                                             const Limits& limits) const;
  // Adds it, or returns the same mesh that is there already. Faults: those of OfferMesh, kNotFound.
  Result<MeshEntry> AddMesh(MeshEntry entry, const Limits& limits);
  // Forgets it and the handle sets on it. kNotFound.
  Status DeleteMesh(const std::string& mesh_id);

  // The same for handle sets; "the same" is the same mesh id and the same definitions.
  Result<HandleSetEntry> FindHandleSet(const std::string& handle_set_id) const;
  Result<std::optional<HandleSetEntry>> OfferHandleSet(const std::string& handle_set_id,
                                                       const std::string& mesh_id,
                                                       const std::vector<Handle>& definitions,
                                                       const Limits& limits) const;
  // Also kNotFound when the mesh that the set was compiled on is no longer under its id.
  Result<HandleSetEntry> AddHandleSet(HandleSetEntry entry, const Limits& limits);
  // Puts `entry` in the place of its revision − 1. False when that is no longer what is stored.
  Result<bool> ReplaceHandleSet(const HandleSetEntry& entry);
  Status DeleteHandleSet(const std::string& handle_set_id);

 private:
  // All with mutex_ held.
  Result<std::optional<MeshEntry>> OfferMeshLocked(const std::string& mesh_id,
                                                   const std::string& hash,
                                                   const Limits& limits) const;
  Result<std::optional<HandleSetEntry>> OfferHandleSetLocked(const std::string& handle_set_id,
                                                             const std::string& mesh_id,
                                                             const std::vector<Handle>& definitions,
                                                             const Limits& limits) const;
  Status CheckAliveLocked() const;

  const SessionSpec spec_;
  const runtime::Clock& clock_;
  const runtime::Clock::Wall created_;

  mutable std::mutex mutex_;
  // Guarded by mutex_.
  runtime::Clock::Steady expires_;
  bool ended_ = false;
  std::map<std::string, MeshEntry> meshes_;
  std::map<std::string, HandleSetEntry> handle_sets_;
  std::uint64_t next_listener_ = 1;
  std::map<std::uint64_t, Listener> listeners_;
};

}  // namespace arap::app
