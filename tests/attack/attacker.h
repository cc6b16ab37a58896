// The attacker's end: what an attack is, what it is given and what it has spent.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <grpcpp/grpcpp.h>

#include "tests/system/fault/client.h"

namespace arap::attack {

// In a process of its own, which is killed when the attack is over. Thread-safe.
class Attacker {
 public:
  Attacker(std::string address, std::string admin, std::string token)
      : address_(std::move(address)), admin_(std::move(admin)), token_(std::move(token)) {}

  const std::string& address() const { return address_; }  // of the gRPC service
  const std::string& admin() const { return admin_; }      // of the admin page
  const std::string& token() const { return token_; }      // of the owner "mallory"

  // Everything is prepared: from now on the bystander's troubles count.
  void Begin();
  // What was spent, told to whoever started the attack a few times a second.
  void Spend(std::size_t calls, std::size_t bytes = 0) {
    calls_ += calls;
    bytes_ += bytes;
  }
  // Counts a call, and whether it was refused.
  void Count(const grpc::Status& status, std::size_t bytes = 0);
  // Makes a unary call whose answer nobody looks at; counted.
  template <class Stub, class Request, class Response>
  grpc::Status Call(Stub& stub,
                    grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, Response*),
                    const Request& request, std::chrono::milliseconds timeout) {
    Response response;
    grpc::ClientContext context;
    fault::SetDeadline(context, timeout);
    const grpc::Status status = (stub.*method)(&context, request, &response);
    Count(status, request.ByteSizeLong());
    return status;
  }

  // Runs `work(i)` for 0 to threads − 1, each in a thread, again and again for ever.
  [[noreturn]] void Loop(int threads, const std::function<void(int)>& work);
  // Tells what was spent, for ever: for an attack that holds what it has.
  [[noreturn]] void Hold();

 private:
  void Tell();

  const std::string address_, admin_, token_;
  std::atomic<std::size_t> calls_ = 0, refused_ = 0, bytes_ = 0;
};

struct Attack {
  const char* name;
  const char* what;  // in half a sentence
  std::function<void(Attacker&)> run;
  std::size_t budget_megabytes = 512;  // --max-bytes; an owner may have half of it
};

// Those of each room, and all.
std::vector<Attack> AttacksBeforeIdentity();
std::vector<Attack> AttacksByCost();
std::vector<Attack> AttacksOnMemory();
std::vector<Attack> AttacksOnFairness();
std::vector<Attack> AllAttacks();

// A client of mallory's on a connection of its own, and a session "s" with a grid of n × n squares
// as "m". Ends the program when the server refuses it.
class Mallory {
 public:
  Mallory(Attacker& attacker, int n, const std::string& session = "s");

  // "h0", "h1"… on vertices spread evenly over the grid.
  std::vector<v1::Handle> Handles(std::size_t count) const;
  // Compiles `handles` as `set`; counted.
  grpc::Status Compile(const std::string& set, std::span<const v1::Handle> handles,
                       std::chrono::milliseconds timeout = std::chrono::seconds(10));
  // Moves h0 of `set`; counted.
  grpc::Status Deform(const std::string& set, std::size_t handles, std::uint32_t refine,
                      std::chrono::milliseconds timeout, std::size_t picks = 0);

  fault::FaultClient& client() { return client_; }
  const std::string& session() const { return session_; }
  int size() const { return n_; }

 private:
  Attacker& attacker_;
  const int n_;
  const std::string session_;
  fault::FaultClient client_;
};

}  // namespace arap::attack
