#include "tests/system/fault/ledger.h"

#include <algorithm>
#include <functional>

#include <gtest/gtest.h>

namespace arap::fault {
namespace {

using Stub = v1::DeformationService::Stub;

std::string DifferenceOfSets(const std::string& id, const SetEntry& expected,
                             const SetEntry& found) {
  if (expected.mesh_id != found.mesh_id) return "set " + id + " is on mesh " + found.mesh_id;
  if (expected.revision != found.revision) {
    return "set " + id + " has revision " + std::to_string(found.revision) + " for " +
           std::to_string(expected.revision);
  }
  return expected.handle_ids == found.handle_ids ? "" : "set " + id + " has other handles";
}

// The number of characters says where a target is: any function of the id would do.
double Number(const std::string& id, double factor) {
  double sum = 0;
  for (const char letter : id) sum = 0.61 * sum + factor * (letter % 16);
  return sum;
}

}  // namespace

std::string Difference(const MaybeSession& expected, const MaybeSession& found) {
  if (expected.has_value() != found.has_value()) {
    return found ? "the session is there" : "the session is gone";
  }
  if (!expected) return "";
  for (const auto& [id, hash] : found->meshes) {
    const auto told = expected->meshes.find(id);
    if (told == expected->meshes.end()) return "mesh " + id + " is there";
    if (!told->second.empty() && told->second != hash) return "mesh " + id + " is another";
  }
  for (const auto& [id, hash] : expected->meshes) {
    if (!found->meshes.contains(id)) return "mesh " + id + " is gone";
  }
  for (const auto& [id, set] : found->sets) {
    const auto told = expected->sets.find(id);
    if (told == expected->sets.end()) return "set " + id + " is there";
    if (auto difference = DifferenceOfSets(id, told->second, set); !difference.empty()) {
      return difference;
    }
  }
  for (const auto& [id, set] : expected->sets) {
    if (!found->sets.contains(id)) return "set " + id + " is gone";
  }
  return "";
}

MaybeSession ReadSession(FaultClient& client, const std::string& session_id) {
  v1::GetSessionRequest request;
  request.set_session_id(session_id);
  v1::GetSessionResponse response;
  const grpc::Status status = client.Call(&Stub::GetSession, request, &response);
  if (status.error_code() == grpc::NOT_FOUND) return std::nullopt;
  EXPECT_TRUE(status.ok()) << status.error_message();
  SessionEntry entry;
  for (const std::string& id : response.session().mesh_ids()) {
    v1::GetMeshRequest mesh;
    mesh.set_session_id(session_id);
    mesh.set_mesh_id(id);
    v1::GetMeshResponse answer;
    const grpc::Status got = client.Call(&Stub::GetMesh, mesh, &answer);
    EXPECT_TRUE(got.ok()) << session_id << " mesh " << id << ": " << got.error_message();
    entry.meshes[id] = answer.mesh().content_hash();
  }
  for (const std::string& id : response.session().handle_set_ids()) {
    v1::GetHandleSetRequest set;
    set.set_session_id(session_id);
    set.set_handle_set_id(id);
    v1::GetHandleSetResponse answer;
    const grpc::Status got = client.Call(&Stub::GetHandleSet, set, &answer);
    EXPECT_TRUE(got.ok()) << session_id << " set " << id << ": " << got.error_message();
    SetEntry& found = entry.sets[id];
    found.mesh_id = answer.handle_set().mesh_id();
    found.revision = answer.handle_set().revision();
    for (const v1::HandleInfo& handle : answer.handle_set().handles()) {
      found.handle_ids.push_back(handle.handle_id());
    }
  }
  return entry;
}

std::vector<std::string> ReadSessionIds(FaultClient& client) {
  std::vector<std::string> ids;
  v1::ListSessionsRequest request;
  request.set_page_size(7);  // several pages
  do {
    v1::ListSessionsResponse response;
    const grpc::Status status = client.Call(&Stub::ListSessions, request, &response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    for (const v1::Session& session : response.sessions()) ids.push_back(session.session_id());
    request.set_page_token(response.next_page_token());
  } while (!request.page_token().empty());
  return ids;
}

std::vector<v1::HandleTarget> FixedTargets(const std::vector<std::string>& handle_ids) {
  std::vector<v1::HandleTarget> targets;
  for (const std::string& id : handle_ids) {
    targets.push_back(wire::TargetAt(id, Number(id, 0.3), Number(id, 0.2)));
  }
  return targets;
}

std::string BytesOf(const v1::Shape& shape) {
  const auto& numbers = shape.positions64();
  return {reinterpret_cast<const char*>(numbers.data()),
          sizeof(double) * static_cast<std::size_t>(numbers.size())};
}

}  // namespace arap::fault
