#include "server/rpc/stream_work.h"

#include <string>
#include <utility>

#include <arap/v1/deformation_service.pb.h>

#include "core/base/try.h"
#include "server/sessions/handle_sets.h"

namespace arap::rpc {

Result<app::Warmth> StreamWork::Find(const v1::OpenStream& open) {
  TRY(session_, engine_.sessions.Use(caller_.owner, open.session_id()));
  return app::PeekHandleSet(engine_, *session_, open.handle_set_id()).warmth;
}

Status StreamWork::Open(const v1::OpenStream& open, const CancelToken& cancel,
                        const std::function<Status(double)>& admit, v1::StreamOpened* out) {
  TRY(auto entry, app::WarmHandleSet(engine_, caller_, *session_, open.handle_set_id(), cancel));
  TRY(options_, FromWire(open.options(), engine_.limits, *entry.handles->mesh()));
  TRY(latest_only_, LatestOnly(open.delivery()));
  CHECK_OK(admit(EstimateFrame(*entry.handles, options_.deform).seconds()));
  TRY(room_, engine_.derived.Reserve(caller_, BytesOf(*entry.handles)));
  ToWire(entry, out->mutable_handle_set());
  Append(options_.vertices, out->mutable_vertices());
  live_.emplace(std::move(entry));
  return {};
}

Result<std::vector<Target>> StreamWork::Edit(const v1::HandleEdit& edit,
                                             std::span<const Target> targets,
                                             const CancelToken& cancel, const ShapeTimes& times,
                                             v1::Shape* out) {
  TRY(const auto add, FromWire(edit.add(), "add"));
  const std::vector<std::string> remove(edit.remove().begin(), edit.remove().end());
  TRY(const arap::Cost cost, app::EditCostOf(live_->entry(), remove, add, engine_.limits, cancel));
  // What is added is this stream's own: it counts for as long as the stream has it.
  TRY(auto room, engine_.derived.Reserve(caller_, BytesOf(handles()) + cost.bytes));
  TRY(auto edited, live_->Edited(remove, add, targets, options_.deform, engine_.limits, cancel,
                                 engine_.metrics));
  CHECK_OK(ToWire(edited.set, edited.quality, options_, {}, cancel, times, out));
  const CompiledHandles& handles = *edited.set.entry().handles;
  room.Shrink(BytesOf(handles) + handles.bytes());
  room_ = std::move(room);
  live_.emplace(std::move(edited.set));
  return std::move(edited.targets);
}

std::size_t StreamWork::BytesOf(const CompiledHandles& handles) const {
  return app::LiveSet::BytesOf(handles, options_.deform, 1) + options_.bytes();
}

}  // namespace arap::rpc
