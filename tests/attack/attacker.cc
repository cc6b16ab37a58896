#include "tests/attack/attacker.h"

#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <thread>

#include <poll.h>

namespace arap::attack {
namespace {

constexpr int kTellMillis = 200;
constexpr double kMegabyte = 1 << 20;
constexpr std::chrono::seconds kSetUp{20};

void Must(const grpc::Status& status, const char* what) {
  if (status.ok()) return;
  std::fprintf(stderr, "the attack cannot be prepared, %s: %s\n", what,
               status.error_message().c_str());
  std::exit(1);  // NOLINT(concurrency-mt-unsafe): nothing of ours has an end to come
}

}  // namespace

void Attacker::Begin() {
  std::printf("begins\n");
  std::fflush(stdout);
}

void Attacker::Count(const grpc::Status& status, std::size_t bytes) {
  Spend(1, bytes);
  if (!status.ok()) ++refused_;
}

void Attacker::Tell() {
  std::printf("spent %zu calls (%zu not answered), %.1f MB\n", calls_.load(), refused_.load(),
              static_cast<double>(bytes_) / kMegabyte);
  std::fflush(stdout);
}

void Attacker::Loop(int threads, const std::function<void(int)>& work) {
  std::vector<std::thread> all;
  all.reserve(static_cast<std::size_t>(threads));
  for (int i = 0; i < threads; ++i) {
    all.emplace_back([&work, i] {
      for (;;) work(i);
    });
  }
  Hold();
}

void Attacker::Hold() {
  for (;;) {
    Tell();
    poll(nullptr, 0, kTellMillis);
  }
}

std::vector<Attack> AllAttacks() {
  std::vector<Attack> all;
  for (auto* room : {AttacksBeforeIdentity, AttacksByCost, AttacksOnMemory, AttacksOnFairness}) {
    std::vector<Attack> attacks = room();
    std::move(attacks.begin(), attacks.end(), std::back_inserter(all));
  }
  return all;
}

Mallory::Mallory(Attacker& attacker, int n, const std::string& session)
    : attacker_(attacker), n_(n), session_(session), client_(attacker.address(), attacker.token()) {
  Must(client_.CreateSession(session), "the session");
  v1::RegisterMeshRequest request;
  request.set_session_id(session);
  request.set_mesh_id("m");
  *request.mutable_mesh() = wire::Grid(n, n);
  v1::RegisterMeshResponse response;
  grpc::ClientContext context;
  fault::SetDeadline(context, kSetUp);
  Must(client_.deformation().RegisterMesh(&context, request, &response), "the mesh");
}

std::vector<v1::Handle> Mallory::Handles(std::size_t count) const {
  const auto vertices = static_cast<std::size_t>(n_ + 1) * static_cast<std::size_t>(n_ + 1);
  std::vector<v1::Handle> handles;
  for (std::size_t i = 0; i < count; ++i) {
    handles.push_back(wire::VertexHandle(
        "h" + std::to_string(i),
        static_cast<std::uint32_t>(i * (vertices - 1) / std::max<std::size_t>(1, count - 1))));
  }
  return handles;
}

grpc::Status Mallory::Compile(const std::string& set, std::span<const v1::Handle> handles,
                              std::chrono::milliseconds timeout) {
  v1::CompileHandlesRequest request;
  request.set_session_id(session_);
  request.set_mesh_id("m");
  request.set_handle_set_id(set);
  request.mutable_handles()->Assign(handles.begin(), handles.end());
  return attacker_.Call(client_.deformation(), &v1::DeformationService::Stub::CompileHandles,
                        request, timeout);
}

grpc::Status Mallory::Deform(const std::string& set, std::size_t handles, std::uint32_t refine,
                             std::chrono::milliseconds timeout, std::size_t picks) {
  v1::DeformRequest request;
  request.set_session_id(session_);
  request.set_handle_set_id(set);
  request.mutable_options()->set_refine(refine);
  for (std::size_t i = 0; i < handles; ++i) {
    *request.add_targets() =
        wire::TargetAt("h" + std::to_string(i), static_cast<double>(i), i == 0 ? 3 : 0);
  }
  for (std::size_t i = 0; i < picks; ++i) {
    request.add_pick_points(static_cast<double>(i % static_cast<std::size_t>(n_)));
    request.add_pick_points(0.5 + static_cast<double>(i) / static_cast<double>(picks));
  }
  return attacker_.Call(client_.deformation(), &v1::DeformationService::Stub::Deform, request,
                        timeout);
}

}  // namespace arap::attack
