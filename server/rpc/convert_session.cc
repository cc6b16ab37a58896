#include "server/rpc/convert_session.h"

#include <cstdint>

#include <arap/v1/deformation_service.pb.h>
#include <google/protobuf/duration.pb.h>
#include <google/protobuf/timestamp.pb.h>

namespace arap::rpc {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;

constexpr std::int64_t kNanos = 1'000'000'000;
// The range of google.protobuf.Duration: 10000 years.
constexpr std::int64_t kMaxDurationSeconds = 315'576'000'000;

void SetTimestamp(runtime::Clock::Wall time, google::protobuf::Timestamp* out) {
  const auto since = std::chrono::duration_cast<nanoseconds>(time.time_since_epoch()).count();
  out->set_seconds(since / kNanos);
  out->set_nanos(static_cast<std::int32_t>(since % kNanos));
}

}  // namespace

Result<app::SessionSpec> FromWire(const v1::CreateSessionRequest& request) {
  app::SessionSpec spec;
  spec.id = request.session_id();
  spec.labels = {request.labels().begin(), request.labels().end()};
  if (request.has_ttl()) {
    const auto& ttl = request.ttl();
    const bool valid = ttl.seconds() >= 0 && ttl.seconds() <= kMaxDurationSeconds &&
                       ttl.nanos() >= 0 && ttl.nanos() < kNanos;
    // The range is checked in milliseconds; a shorter ttl than that must not become "not set".
    const milliseconds rounded =
        valid ? seconds(ttl.seconds()) + milliseconds(ttl.nanos() / 1'000'000)
              : milliseconds::zero();
    if (rounded == milliseconds::zero()) {
      return Fail(Fault(FaultKind::kInvalidOption, "The ttl is not a time of at least 1 s.")
                      .Field("ttl")
                      .Detail("quota", "max_ttl"));
    }
    spec.ttl = rounded;
  }
  return spec;
}

void ToWire(const app::SessionView& view, v1::Session* out) {
  out->set_session_id(view.spec.id);
  out->set_owner(view.owner);
  SetTimestamp(view.created, out->mutable_create_time());
  SetTimestamp(view.expires, out->mutable_expire_time());
  SetDuration(view.spec.ttl, out->mutable_ttl());
  out->mutable_labels()->insert(view.spec.labels.begin(), view.spec.labels.end());
  for (const std::string& id : view.mesh_ids) out->add_mesh_ids(id);
  for (const std::string& id : view.handle_set_ids) out->add_handle_set_ids(id);
}

void SetDuration(nanoseconds time, google::protobuf::Duration* out) {
  out->set_seconds(time.count() / kNanos);
  out->set_nanos(static_cast<std::int32_t>(time.count() % kNanos));
}

void SetMicros(double micros, google::protobuf::Duration* out) {
  SetDuration(nanoseconds(static_cast<std::int64_t>(micros * 1e3)), out);
}

}  // namespace arap::rpc
