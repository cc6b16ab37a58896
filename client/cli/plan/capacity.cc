#include "client/cli/plan/capacity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace arap::cli {
namespace {

// Measured on 2026-11-30 on two threads of an AMD EPYC that others used too, with an arapd of that
// day in memory, its defaults but for the numbers of sessions and streams; a grid, EDGE cells, soft
// handles, float32. Seconds of processor time and bytes. docs/operations.md has the table.

// `arapctl load --streams 4 --vertices V --handles H`, a closed loop, from 100 to 30,000 vertices:
// the processor time of the process (user and system) over the updates that it answered, the smaller
// of two runs, less a run that only sets up. The formula is within 9 % of the
// twelve that were measured.
constexpr double kMessage = 66e-6;
constexpr double kVertexTime = 5.1e-9;      // for each doubling of the vertices: the factors
constexpr double kVertexTimeRow = 1.85e-9;  // for each handle

// `arapctl mesh register --json`: the bytes of both factors, from 100 to 100,000 vertices.
constexpr double kLeastMeshVertex = 950;
constexpr double kMeshVertex = -855;
constexpr double kMeshDepth = 209;
// `arapctl handles compile --json`.
constexpr double kSetBytes = 2'500;
constexpr double kSetRow = 24;  // of each vertex
// The resident memory of 250 sessions with a stream each, `--stream-rate 2`, less that of 50, over 200.
constexpr double kSessionBytes = 42e3 - kSetBytes;
constexpr double kStreamVertex = 128;
// Of a server with nothing in it.
constexpr double kServerBytes = 60e6;

// used_memory of Redis with 300 sessions of a mesh and a handle set each, over 300.
constexpr double kRecordBytes = 3'000;
constexpr double kRecordHandle = 160;
// How often a session that is used moves its expiry in the store.
constexpr double kExpirySeconds = 30;

// By the format: four bytes a coordinate, a name of eight characters and two numbers a target.
constexpr double kPositionBytes = 8;
constexpr double kShapeBytes = 160;
constexpr double kTargetBytes = 32;
constexpr double kUpdateBytes = 60;

}  // namespace

std::string NameOf(Scarce bound) {
  constexpr std::array<const char*, 3> kNames{"cores", "memory", "network"};
  return kNames[static_cast<std::size_t>(bound)];
}

UpdateCost CostOfUpdate(const Puppets& puppets) {
  const double vertices = puppets.vertices, rows = puppets.handles;
  UpdateCost cost;
  cost.core_seconds =
      kMessage + vertices * (kVertexTime * std::log2(vertices) + kVertexTimeRow * rows);
  cost.bytes_out = kShapeBytes + kPositionBytes * vertices;
  cost.bytes_in = kUpdateBytes + kTargetBytes * rows;
  return cost;
}

MemoryCost CostOfMemory(const Puppets& puppets) {
  const double vertices = puppets.vertices, rows = puppets.handles;
  MemoryCost cost;
  cost.mesh = vertices * std::max(kLeastMeshVertex, kMeshVertex + kMeshDepth * std::log2(vertices));
  cost.session = kSessionBytes + kSetBytes + vertices * (kStreamVertex + kSetRow * rows);
  cost.record = kRecordBytes + kRecordHandle * rows;
  return cost;
}

Plan MakePlan(const Puppets& puppets, const Machine& machine, double servers) {
  Plan plan;
  plan.update = CostOfUpdate(puppets);
  if (machine.update_seconds > 0) plan.update.core_seconds = machine.update_seconds;
  plan.memory = CostOfMemory(puppets);
  plan.updates = puppets.count * puppets.fps;
  plan.updates_per_core = 1 / plan.update.core_seconds;
  plan.bytes_out = plan.updates * plan.update.bytes_out;
  plan.store_writes = puppets.count / kExpirySeconds;
  plan.store_bytes = puppets.count * plan.memory.record;

  const double cores = plan.updates * plan.update.core_seconds;
  const double held = puppets.count * plan.memory.session;
  const double most_meshes = std::min(puppets.meshes, puppets.count);
  const double room = machine.memory * machine.memory_target - kServerBytes;
  plan.for_cores = cores / (machine.cores * machine.target);
  plan.for_network = plan.bytes_out / (machine.network * machine.target);
  // With so many servers each has no more meshes than puppets.
  const double shared = room - most_meshes * plan.memory.mesh;
  const double own = puppets.count * (plan.memory.session + plan.memory.mesh) / room;
  plan.for_memory = shared > 0 ? held / shared : std::numeric_limits<double>::infinity();
  if (room > plan.memory.session + plan.memory.mesh)
    plan.for_memory = std::min(plan.for_memory, own);

  std::array<std::pair<double, Scarce>, 3> bounds{{{plan.for_cores, Scarce::kCores},
                                                   {plan.for_memory, Scarce::kMemory},
                                                   {plan.for_network, Scarce::kNetwork}}};
  std::stable_sort(bounds.begin(), bounds.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  plan.bound = bounds[0].second;
  plan.next = bounds[1].second;
  plan.servers = servers > 0 ? servers : std::max(1.0, std::ceil(bounds[0].first));
  const double here = puppets.count / plan.servers;
  const double meshes = std::min(most_meshes, std::ceil(here));
  plan.core_use = cores / (plan.servers * machine.cores);
  plan.network_use = plan.bytes_out / (plan.servers * machine.network);
  plan.memory_use =
      (kServerBytes + meshes * plan.memory.mesh + here * plan.memory.session) / machine.memory;
  return plan;
}

}  // namespace arap::cli
