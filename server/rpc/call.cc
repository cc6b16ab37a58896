#include "server/rpc/call.h"

#include "server/engine.h"

namespace arap::rpc {

Result<std::shared_ptr<app::Session>> SessionOf(app::Engine& engine, const Call& call,
                                                const std::string& session_id) {
  if (call.session) return call.session;
  return engine.sessions.Use(call.caller.owner, session_id);
}

}  // namespace arap::rpc
