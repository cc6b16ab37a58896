// Costs: what a call is expected to take of a worker, from the lengths of its request and from what
// is in memory.
#pragma once

#include <arap/v1/deformation_service.pb.h>
#include <arap/v1/flattening_service.pb.h>

namespace arap::app {
struct Engine;
class Session;
}  // namespace arap::app

namespace arap::rpc {

struct Expected {
  bool cold = false;   // what it names was evicted and has to be computed again
  double seconds = 0;  // of one worker
};

// Never blocks. `session` is the one that the request names, or null when it is not in memory.
Expected ExpectedOf(app::Engine& engine, const app::Session* session,
                    const v1::RegisterMeshRequest& request);
Expected ExpectedOf(app::Engine& engine, const app::Session* session,
                    const v1::GetMeshRequest& request);
Expected ExpectedOf(app::Engine& engine, const app::Session* session,
                    const v1::CompileHandlesRequest& request);
Expected ExpectedOf(app::Engine& engine, const app::Session* session,
                    const v1::EditHandlesRequest& request);
Expected ExpectedOf(app::Engine& engine, const app::Session* session,
                    const v1::GetHandleSetRequest& request);
Expected ExpectedOf(app::Engine& engine, const app::Session* session,
                    const v1::DeformRequest& request);
Expected ExpectedOf(app::Engine& engine, const app::Session* session,
                    const v1::FlattenRequest& request);

}  // namespace arap::rpc
