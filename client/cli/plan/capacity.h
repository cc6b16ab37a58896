// What puppets cost a server: memory, processor time and bytes, by their size. Measured, not
// reckoned from the code; the constants are in capacity.cc, each with how it came about, and
// docs/operations.md has what the formulas give beside what was measured.
#pragma once

#include <cstddef>
#include <string>

namespace arap::cli {

// What is asked for.
struct Puppets {
  double count = 0;     // open at the same time
  double vertices = 0;  // of each
  double fps = 0;       // updates of each a second
  double handles = 8;   // each a soft point: one row
  double meshes = 1;    // different ones; equal meshes of an owner are held once on each server
};

// A server that they are to run on.
struct Machine {
  double cores = 8;
  double memory = 32e9;        // bytes
  double network = 10e9 / 8;   // bytes a second, out
  double target = 0.7;         // how busy a core may be, so that bursts have room
  double memory_target = 0.8;  // the rest is for the system and for what moves here in a failover
  double update_seconds = 0;   // of a core for an update, where it was measured; 0: by CostOfUpdate
};

// Of one update.
struct UpdateCost {
  double core_seconds = 0;  // of the server: its workers, gRPC and the system for it
  double bytes_out = 0;     // the shape in float32 with its frame
  double bytes_in = 0;
};
// How much the time of an update differs from one to the next: deviation over mean. Of equal puppets
// in a closed loop 0.11; caches that others have used since make it more.
inline constexpr double kServiceVariation = 0.3;
UpdateCost CostOfUpdate(const Puppets& puppets);

// Bytes of what is held.
struct MemoryCost {
  double mesh = 0;     // of each mesh, once on a server
  double session = 0;  // of each puppet: session, handle set, stream, its frames on the way
  double record = 0;   // of each puppet in the store of sessions
};
MemoryCost CostOfMemory(const Puppets& puppets);

// What keeps one server from taking more, first the one that it hits first.
enum class Scarce { kCores, kMemory, kNetwork };
std::string NameOf(Scarce bound);

struct Plan {
  UpdateCost update;
  MemoryCost memory;
  double updates = 0;  // a second, of all puppets
  double updates_per_core = 0;
  double bytes_out = 0;     // a second
  double store_writes = 0;  // a second: what moves expiries
  double store_bytes = 0;
  // Servers that each resource wants, not rounded; memory may be more than any number of them has
  // when the meshes alone do not fit: then it is infinite.
  double for_cores = 0, for_memory = 0, for_network = 0;
  double servers = 0;  // enough for all of them
  Scarce bound = Scarce::kCores;
  Scarce next = Scarce::kMemory;
  // Of one server, when `servers` share the puppets evenly.
  double core_use = 0, memory_use = 0, network_use = 0;
};
// With `servers` 0 as many as are wanted, else so many.
Plan MakePlan(const Puppets& puppets, const Machine& machine, double servers);

}  // namespace arap::cli
