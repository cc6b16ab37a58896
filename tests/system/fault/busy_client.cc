#include "tests/system/fault/busy_client.h"

#include <algorithm>
#include <utility>

#include <gtest/gtest.h>

namespace arap::fault {
namespace {

using Stub = v1::DeformationService::Stub;

constexpr std::size_t kMaxSessions = 3;
constexpr std::size_t kMaxMeshes = 3;
constexpr std::size_t kMaxSets = 3;

// Codes of a server that has just died.
bool IsGone(const grpc::Status& status) {
  return status.error_code() == grpc::UNAVAILABLE || status.error_code() == grpc::UNKNOWN ||
         status.error_code() == grpc::INTERNAL || status.error_code() == grpc::CANCELLED;
}

template <class Map>
const std::string& AnyKey(const Map& map, testing::Random& random) {
  return std::next(map.begin(), static_cast<std::ptrdiff_t>(random.Below(map.size())))->first;
}

}  // namespace

void BusyClient::Work(const std::string& address, std::atomic<std::size_t>& acknowledged) {
  FaultClient client(address);
  open_session_.clear();
  while (Step(client)) ++acknowledged;
}

bool BusyClient::Step(FaultClient& client) {
  if (sessions_.empty() || (sessions_.size() < kMaxSessions && random_.Below(8) == 0)) {
    return Create(client);
  }
  const std::string session = AnyKey(sessions_, random_);
  const SessionEntry& entry = sessions_[session];
  const std::size_t dice = random_.Below(16);
  if (dice == 0) return Remove(client, session);
  if (entry.meshes.empty() || (dice <= 3 && entry.meshes.size() < kMaxMeshes)) {
    return Register(client, session);
  }
  if (entry.sets.empty() || (dice <= 6 && entry.sets.size() < kMaxSets)) {
    return Compile(client, session);
  }
  const std::string set = AnyKey(entry.sets, random_);
  if (dice <= 10) return Edit(client, session, set);
  return dice <= 13 ? Ask(client, session, set) : Drag(client, session, set);
}

MaybeSession BusyClient::Known(const std::string& session) const {
  const auto found = sessions_.find(session);
  if (found == sessions_.end()) return std::nullopt;
  return found->second;
}

std::string BusyClient::NewId(const char* kind) { return kind + std::to_string(++next_id_); }

bool BusyClient::Try(const std::string& session, const MaybeSession& after,
                     const std::function<grpc::Status()>& call) {
  open_session_ = session;
  open_after_ = after;
  const grpc::Status status = call();
  if (!status.ok()) {
    EXPECT_TRUE(IsGone(status)) << session << ": " << status.error_code() << ' '
                                << status.error_message();
    return false;
  }
  if (open_after_) {
    sessions_[session] = *std::exchange(open_after_, std::nullopt);
  } else {
    sessions_.erase(session);
  }
  open_session_.clear();
  return true;
}

bool BusyClient::Create(FaultClient& client) {
  const std::string session = name_ + NewId("-s");
  return Try(session, SessionEntry{}, [&] { return client.CreateSession(session); });
}

bool BusyClient::Register(FaultClient& client, const std::string& session) {
  v1::RegisterMeshRequest request;
  request.set_session_id(session);
  request.set_mesh_id(NewId("m"));
  const int width = 2 + static_cast<int>(random_.Below(6));
  *request.mutable_mesh() = wire::Grid(width, 2 + static_cast<int>(random_.Below(6)));
  for (double& number : *request.mutable_mesh()->mutable_vertices()) {
    number += random_.Uniform(-0.1, 0.1);
  }
  request.mutable_energy()->set_basis(static_cast<v1::Basis>(1 + random_.Below(4)));
  MaybeSession after = Known(session);
  after->meshes[request.mesh_id()];
  return Try(session, after, [&] {
    v1::RegisterMeshResponse response;
    const grpc::Status status = client.Call(&Stub::RegisterMesh, request, &response);
    open_after_->meshes[request.mesh_id()] = response.mesh().content_hash();
    return status;
  });
}

bool BusyClient::Compile(FaultClient& client, const std::string& session) {
  MaybeSession after = Known(session);
  const std::string mesh = AnyKey(after->meshes, random_);
  const std::string id = NewId("h");
  SetEntry& set = after->sets[id];
  set.mesh_id = mesh;
  std::vector<v1::Handle> handles;
  for (const std::uint32_t vertex : {0u, 2u, 7u}) {  // the smallest mesh has nine vertices
    set.handle_ids.push_back(NewId("p"));
    handles.push_back(wire::VertexHandle(set.handle_ids.back(), vertex));
    handles.back().set_hard(random_.Coin());
  }
  return Try(session, after, [&] { return client.Compile(session, mesh, id, handles); }) &&
         Ask(client, session, id);
}

bool BusyClient::Edit(FaultClient& client, const std::string& session, const std::string& set) {
  MaybeSession after = Known(session);
  SetEntry& entry = after->sets[set];
  v1::EditHandlesRequest request;
  request.set_session_id(session);
  request.set_handle_set_id(set);
  // The first goes and comes back under another name.
  const std::vector<std::uint32_t> vertices{0, 2, 7};
  const std::size_t turn = entry.revision % vertices.size();
  request.add_remove(entry.handle_ids.front());
  *request.add_add() = wire::VertexHandle(NewId("p"), vertices[(turn + 2) % vertices.size()]);
  entry.handle_ids.erase(entry.handle_ids.begin());
  entry.handle_ids.push_back(request.add(0).handle_id());
  ++entry.revision;
  entry.answer.clear();
  return Try(session, after,
             [&] {
               v1::EditHandlesResponse response;
               return client.Call(&Stub::EditHandles, request, &response);
             }) &&
         Ask(client, session, set);
}

bool BusyClient::Remove(FaultClient& client, const std::string& session) {
  MaybeSession after = Known(session);
  const std::size_t dice = random_.Below(4);
  if (dice == 0 && !after->meshes.empty()) {
    v1::DeleteMeshRequest request;
    request.set_session_id(session);
    request.set_mesh_id(AnyKey(after->meshes, random_));
    after->meshes.erase(request.mesh_id());
    std::erase_if(after->sets,
                  [&](const auto& set) { return set.second.mesh_id == request.mesh_id(); });
    return Try(session, after, [&] {
      v1::DeleteMeshResponse response;
      return client.Call(&Stub::DeleteMesh, request, &response);
    });
  }
  if (dice <= 2 && !after->sets.empty()) {
    v1::DeleteHandleSetRequest request;
    request.set_session_id(session);
    request.set_handle_set_id(AnyKey(after->sets, random_));
    after->sets.erase(request.handle_set_id());
    return Try(session, after, [&] {
      v1::DeleteHandleSetResponse response;
      return client.Call(&Stub::DeleteHandleSet, request, &response);
    });
  }
  return Try(session, std::nullopt, [&] { return client.DeleteSession(session); });
}

bool BusyClient::Ask(FaultClient& client, const std::string& session, const std::string& set) {
  SetEntry& entry = sessions_[session].sets[set];
  v1::DeformResponse response;
  const grpc::Status status =
      client.Deform(session, set, FixedTargets(entry.handle_ids), &response);
  if (!status.ok()) {
    EXPECT_TRUE(IsGone(status)) << session << ' ' << set << ": " << status.error_message();
    return false;
  }
  const std::string bytes = BytesOf(response.shape());
  EXPECT_FALSE(bytes.empty());
  if (entry.answer.empty()) entry.answer = bytes;
  EXPECT_TRUE(entry.answer == bytes) << session << ' ' << set << " answers other bytes";
  return true;
}

// A stream changes nothing that is kept: it is only something to be killed in.
bool BusyClient::Drag(FaultClient& client, const std::string& session, const std::string& set) {
  const std::vector<std::string> ids = sessions_[session].sets[set].handle_ids;
  grpc::ClientContext context;
  SetDeadline(context);
  const auto stream = client.deformation().StreamDeform(&context);
  v1::StreamDeformRequest request;
  request.mutable_open()->set_session_id(session);
  request.mutable_open()->set_handle_set_id(set);
  request.mutable_open()->set_delivery(v1::DELIVERY_EVERY);
  v1::StreamDeformResponse response;
  bool going = stream->Write(request) && stream->Read(&response);
  for (std::uint64_t sequence = 1; going && sequence <= 5; ++sequence) {
    request.mutable_update()->set_sequence(sequence);
    *request.mutable_update()->mutable_targets() = {};
    *request.mutable_update()->add_targets() =
        wire::TargetAt(ids.front(), random_.Uniform(-1, 1), random_.Uniform(-1, 1));
    going = stream->Write(request) && stream->Read(&response);
    EXPECT_TRUE(!going || response.has_shape()) << response.ShortDebugString();
  }
  stream->WritesDone();
  const grpc::Status status = stream->Finish();
  EXPECT_TRUE(status.ok() || IsGone(status)) << status.error_message();
  return status.ok();
}

void BusyClient::Check(FaultClient& client) {
  if (!open_session_.empty()) {
    const MaybeSession before = Known(open_session_);
    const MaybeSession found = ReadSession(client, open_session_);
    const std::string to_before = Difference(before, found);
    const std::string to_after = Difference(open_after_, found);
    EXPECT_TRUE(to_before.empty() || to_after.empty())
        << open_session_ << " is neither as before its last call (" << to_before
        << ") nor as after it (" << to_after << ")";
    if (to_before.empty()) open_after_ = before;
    if (open_after_ && found) {
      for (const auto& [id, hash] : found->meshes) open_after_->meshes[id] = hash;
      sessions_[open_session_] = *open_after_;
    } else {
      sessions_.erase(open_session_);
    }
    open_session_.clear();
  }
  std::vector<std::string> ids;
  for (const std::string& id : ReadSessionIds(client)) {
    if (id.starts_with(name_ + "-")) ids.push_back(id);
  }
  std::sort(ids.begin(), ids.end());
  std::vector<std::string> expected;
  for (const auto& [id, entry] : sessions_) expected.push_back(id);
  EXPECT_EQ(ids, expected);
  for (const auto& [id, entry] : sessions_) {
    EXPECT_EQ(Difference(entry, ReadSession(client, id)), "") << id;
    for (const auto& [set, ignored] : entry.sets) EXPECT_TRUE(Ask(client, id, set));
  }
}

}  // namespace arap::fault
