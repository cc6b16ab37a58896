// The services of the wire. Each has a file of its name with its methods and their handlers.
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

struct Backend;
struct Identity;

struct NamedService {
  std::string name;  // as in the health service, "arap.v1.DeformationService"
  std::unique_ptr<grpc::Service> service;
};

// All of them. `engine` and `identity` outlive the services, and they outlive the server that they
// are registered with.
std::vector<NamedService> MakeServices(app::Engine& engine, const Identity& identity);

NamedService MakeDeformationService(const Backend& backend);  // deformation_service.cc
NamedService MakeFlatteningService(const Backend& backend);   // flattening_service.cc
NamedService MakeServerService(const Backend& backend);       // server_service.cc

}  // namespace arap::rpc
