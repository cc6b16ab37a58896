#include <arap/v1/deformation_service.pb.h>

#include "server/app/engine.h"
#include "server/rpc/convert_session.h"
#include "server/rpc/handlers.h"

namespace arap::rpc {

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
  auto view = engine.sessions.View(call.caller.owner, request.session_id());
  if (!view) return Fail(std::move(view.error()));
  ToWire(*view, response->mutable_session());
  return {};
}

Status ListSessions(app::Engine& engine, const v1::ListSessionsRequest& request, const Call& call,
                    v1::ListSessionsResponse* response) {
  auto page = engine.sessions.List(call.caller.owner, request.page_size(), request.page_token());
  if (!page) return Fail(std::move(page.error()));
  for (const app::SessionView& view : page->sessions) ToWire(view, response->add_sessions());
  response->set_next_page_token(page->next_token);
  return {};
}

Status DeleteSession(app::Engine& engine, const v1::DeleteSessionRequest& request, const Call& call,
                     v1::DeleteSessionResponse*) {
  return engine.sessions.Delete(call.caller.owner, request.session_id());
}

}  // namespace arap::rpc
