#include "client/src/convert.h"
#include "proto/convert/limits.h"

namespace arap::client::internal {
namespace {

std::chrono::system_clock::time_point FromWire(const google::protobuf::Timestamp& time) {
  const auto since = std::chrono::seconds(time.seconds()) + std::chrono::nanoseconds(time.nanos());
  return std::chrono::system_clock::time_point(
      std::chrono::duration_cast<std::chrono::system_clock::duration>(since));
}

}  // namespace

SessionInfo FromWire(const v1::Session& session) {
  SessionInfo out;
  out.id = session.session_id();
  out.create_time = FromWire(session.create_time());
  out.expire_time = FromWire(session.expire_time());
  out.ttl = FromWire(session.ttl());
  out.labels.insert(session.labels().begin(), session.labels().end());
  out.mesh_ids.assign(session.mesh_ids().begin(), session.mesh_ids().end());
  out.handle_set_ids.assign(session.handle_set_ids().begin(), session.handle_set_ids().end());
  return out;
}

ServerInfo FromWire(const v1::GetServerInfoResponse& response) {
  ServerInfo out;
  out.version = response.version();
  out.limits = convert::FromWire(response.limits());
  out.capabilities.assign(response.capabilities().begin(), response.capabilities().end());
  out.workers = response.workers();
  return out;
}

}  // namespace arap::client::internal
