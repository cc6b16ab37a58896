// StreamWork: what one stream moves, and how its shapes are answered. It owns the memory of both.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "server/budget/derived_cache.h"
#include "server/engine.h"
#include "server/rpc/convert.h"
#include "server/sessions/session_registry.h"
#include "server/streams/live_set.h"
#include "server/streams/stream_policy.h"

namespace arap::v1 {
class HandleEdit;
class OpenStream;
class Shape;
class StreamOpened;
}  // namespace arap::v1

namespace arap::rpc {

// Not thread-safe: one job of the stream at a time.
class StreamWork {
 public:
  // Both outlive it.
  StreamWork(app::Engine& engine, const app::Caller& caller) : engine_(engine), caller_(caller) {}

  // Whether the handle set is at hand, or has to be computed again. Faults: those of SessionRegistry::Use.
  Result<app::Warmth> Find(const v1::OpenStream& open);

  // Takes the handle set of the session that was found, at rest, and writes what the stream is answered.
  // `admit` is asked with the seconds of one frame. Faults: those of the options, of `admit`, of WarmHandleSet and of
  // Reserve.
  Status Open(const v1::OpenStream& open, const CancelToken& cancel,
              const std::function<Status(double)>& admit, v1::StreamOpened* out);

  // Replaces the set by one with other handles, which is this stream's own, and writes its shape; nothing is changed
  // after a fault. Returns the targets of its handles. Faults: those of the edit, of Reserve and of ToWire.
  Result<std::vector<Target>> Edit(const v1::HandleEdit& edit, std::span<const Target> targets,
                                   const CancelToken& cancel, const ShapeTimes& times,
                                   v1::Shape* out);

  // After Find.
  const std::shared_ptr<app::Session>& session() const { return session_; }
  // After Open.
  app::LiveSet& live() { return *live_; }
  const CompiledHandles& handles() const { return *live_->entry().handles; }
  app::LiveHandles Handles(std::vector<Target> targets) const {
    return {live_->entry().handles, std::move(targets)};
  }
  const ShapeOptions& options() const { return options_; }
  bool latest_only() const { return latest_only_; }

 private:
  // Of a live set of these handles.
  std::size_t BytesOf(const CompiledHandles& handles) const;

  app::Engine& engine_;
  const app::Caller& caller_;
  std::shared_ptr<app::Session> session_;
  ShapeOptions options_;
  bool latest_only_ = true;
  std::optional<app::LiveSet> live_;
  app::DerivedCache::Reservation room_;  // for it, and for what edits have added
};

}  // namespace arap::rpc
