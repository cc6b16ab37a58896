// FaultClient: generated stubs on a connection of its own, and the few calls that every test makes.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <arap/v1/deformation_service.grpc.pb.h>
#include <arap/v1/flattening_service.grpc.pb.h>
#include <arap/v1/server_service.grpc.pb.h>
#include <grpcpp/grpcpp.h>

#include "tests/system/wire/wire_fixture.h"

namespace arap::fault {

// Sets a deadline, so that a broken server fails a test instead of hanging it.
void SetDeadline(grpc::ClientContext& context,
                 std::chrono::milliseconds timeout = std::chrono::seconds(30));

// Thread-safe as stubs are. Clients do not share connections.
class FaultClient {
 public:
  // Every call carries the token, unless it is empty.
  explicit FaultClient(const std::string& address, const std::string& token = {});

  v1::DeformationService::Stub& deformation() { return *deformation_; }
  v1::FlatteningService::Stub& flattening() { return *flattening_; }
  v1::ServerService::Stub& server() { return *server_; }

  template <class Request, class Response>
  grpc::Status Call(grpc::Status (v1::DeformationService::Stub::*method)(grpc::ClientContext*,
                                                                         const Request&, Response*),
                    const Request& request, Response* response) {
    grpc::ClientContext context;
    SetDeadline(context);
    return (deformation().*method)(&context, request, response);
  }

  grpc::Status Info();  // GetServerInfo: does it serve at all?
  grpc::Status CreateSession(const std::string& id);
  grpc::Status DeleteSession(const std::string& id);
  grpc::Status Register(const std::string& session, const std::string& mesh,
                        const v1::PlanarMesh& planar);
  grpc::Status Compile(const std::string& session, const std::string& mesh, const std::string& set,
                       const std::vector<v1::Handle>& handles);
  grpc::Status Deform(const std::string& session, const std::string& set,
                      const std::vector<v1::HandleTarget>& targets,
                      v1::DeformResponse* response = nullptr);

  // Session "s", a grid of n × n unit squares as "m" and the set "h": handles "a" and "b" at two
  // corners, vertices 0 (0,0) and n (n,0).
  void SetUp(int n);

 private:
  std::unique_ptr<v1::DeformationService::Stub> deformation_;
  std::unique_ptr<v1::FlatteningService::Stub> flattening_;
  std::unique_ptr<v1::ServerService::Stub> server_;
};

// Looks at `condition` every few milliseconds until it holds: false when `timeout` passes before.
bool Eventually(const std::function<bool()>& condition,
                std::chrono::milliseconds timeout = std::chrono::seconds(20));

}  // namespace arap::fault
