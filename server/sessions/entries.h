// Entries: what a session names, together with what was computed from it.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "arap/core/compiled_handles.h"
#include "arap/core/registered_mesh.h"

namespace arap::app {

// A mesh under the id that the client gave it.
struct MeshEntry {
  std::string mesh_id;
  std::string content_hash;  // also the name of its blob
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

}  // namespace arap::app
