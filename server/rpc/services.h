// The services of the wire, each RPC on its lane.
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace grpc {
class Service;
}
namespace arap::app {
struct Engine;
}

namespace arap::rpc {

struct Identity;

struct NamedService {
  std::string name;  // as in the health service, "arap.v1.DeformationService"
  std::unique_ptr<grpc::Service> service;
};

// `engine` and `identity` outlive the services, and they outlive the server that they are
// registered with.
std::vector<NamedService> MakeServices(app::Engine& engine, const Identity& identity);

}  // namespace arap::rpc
