#include <arap/v1/deformation_service.pb.h>

#include "server/engine.h"
#include "server/rpc/convert_session.h"
#include "server/rpc/handlers.h"
#include "server/sessions/names.h"

namespace arap::rpc {
namespace {

// Whose sessions are meant. `missing` is what somebody hears who may not ask: the same as when
// there is nothing.
Result<std::string> OwnerOf(const Call& call, const std::string& owner, Fault missing) {
  const app::Caller& caller = call.caller;
  if (owner.empty() || owner == caller.owner) return caller.owner;
  if (caller.role == app::Role::kAdmin && app::IsName(owner)) return owner;
  return Fail(std::move(missing));
}

}  // namespace

Status CreateSession(app::Engine& engine, const v1::CreateSessionRequest& request, const Call& call,
                     v1::CreateSessionResponse* response) {
  auto spec = FromWire(request);
  if (!spec) return Fail(std::move(spec.error()));
  auto view = engine.sessions.Create(call.caller, *std::move(spec));
  if (!view) return Fail(std::move(view.error()));
  ToWire(*view, response->mutable_session());
  return {};
}

Status GetSession(app::Engine& engine, const v1::GetSessionRequest& request, const Call& call,
                  v1::GetSessionResponse* response) {
  auto owner = OwnerOf(call, request.owner(), app::NotFound("session", request.session_id()));
  if (!owner) return Fail(std::move(owner.error()));
  auto view = engine.sessions.View(*owner, request.session_id());
  if (!view) return Fail(std::move(view.error()));
  ToWire(*view, response->mutable_session());
  return {};
}

Status ListSessions(app::Engine& engine, const v1::ListSessionsRequest& request, const Call& call,
                    v1::ListSessionsResponse* response) {
  auto owner = OwnerOf(call, request.owner(), app::NotFound("owner", request.owner()));
  if (!owner) return Fail(std::move(owner.error()));
  auto page = engine.sessions.List(*owner, request.page_size(), request.page_token());
  if (!page) return Fail(std::move(page.error()));
  for (const app::SessionView& view : page->sessions) ToWire(view, response->add_sessions());
  response->set_next_page_token(page->next_token);
  return {};
}

Status DeleteSession(app::Engine& engine, const v1::DeleteSessionRequest& request, const Call& call,
                     v1::DeleteSessionResponse*) {
  auto owner = OwnerOf(call, request.owner(), app::NotFound("session", request.session_id()));
  if (!owner) return Fail(std::move(owner.error()));
  return engine.sessions.Delete(*owner, request.session_id());
}

}  // namespace arap::rpc
