// Owner × resource × RPC: whatever belongs to somebody else answers exactly as though it were not
// there, and stays as it was.
#include <functional>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "tests/system/wire/token_fixture.h"
#include "tests/system/wire/wire_fixture.h"

namespace arap::wire {
namespace {

// Which parts of "s" / "m" / "h" a request names; the others of somebody else's are "x", which
// nobody has.
struct Names {
  std::string session, mesh, set;
};

struct Access {
  const char* rpc;
  std::function<grpc::Status(grpc::ClientContext*, const Names&)> call;
};

class IsolationTest : public WireTest {
 protected:
  IsolationTest() {
    folder_.PutTokens({alice_.Entry(), bob_.Entry(), admin_.Entry()});
    options().credentials.token_file = folder_.tokens();
    options().credentials.refresh = std::chrono::hours(1);
  }

  grpc::Status As(const TestToken& token, const Access& access, const Names& names) {
    grpc::ClientContext context;
    SetDeadline(context);
    context.AddMetadata("authorization", "Bearer " + token.Text());
    return access.call(&context, names);
  }

  template <class Request, class Response>
  Access Unary(const char* rpc,
               grpc::Status (Deformation::*method)(grpc::ClientContext*, const Request&, Response*),
               std::function<void(Request&, const Names&)> fill) {
    return {rpc, [this, method, fill](grpc::ClientContext* context, const Names& names) {
              Request request;
              request.set_session_id(names.session);
              fill(request, names);
              Response response;
              return (deformation().*method)(context, request, &response);
            }};
  }

  // Every RPC that names something that belongs to somebody.
  std::vector<Access> Everything() {
    using D = Deformation;
    std::vector<Access> all;
    all.push_back(Unary<v1::GetSessionRequest, v1::GetSessionResponse>("GetSession", &D::GetSession,
                                                                       [](auto&, const Names&) {}));
    all.push_back(Unary<v1::RegisterMeshRequest, v1::RegisterMeshResponse>(
        "RegisterMesh", &D::RegisterMesh, [](auto& request, const Names& names) {
          request.set_mesh_id(names.mesh);
          *request.mutable_mesh() = Grid(2, 2);
        }));
    all.push_back(Unary<v1::GetMeshRequest, v1::GetMeshResponse>(
        "GetMesh", &D::GetMesh,
        [](auto& request, const Names& names) { request.set_mesh_id(names.mesh); }));
    all.push_back(Unary<v1::CompileHandlesRequest, v1::CompileHandlesResponse>(
        "CompileHandles", &D::CompileHandles, [](auto& request, const Names& names) {
          request.set_mesh_id(names.mesh);
          request.set_handle_set_id(names.set);
          *request.add_handles() = VertexHandle("a", 0);
        }));
    all.push_back(Unary<v1::EditHandlesRequest, v1::EditHandlesResponse>(
        "EditHandles", &D::EditHandles,
        [](auto& request, const Names& names) { request.set_handle_set_id(names.set); }));
    all.push_back(Unary<v1::GetHandleSetRequest, v1::GetHandleSetResponse>(
        "GetHandleSet", &D::GetHandleSet,
        [](auto& request, const Names& names) { request.set_handle_set_id(names.set); }));
    all.push_back(Unary<v1::DeformRequest, v1::DeformResponse>(
        "Deform", &D::Deform, [](auto& request, const Names& names) {
          request.set_handle_set_id(names.set);
          *request.add_targets() = TargetAt("a", 0, 0);
        }));
    all.push_back({"DeformTrack", [this](grpc::ClientContext* context, const Names& names) {
                     v1::DeformTrackRequest request;
                     request.set_session_id(names.session);
                     request.set_handle_set_id(names.set);
                     request.add_handle_ids("a");
                     request.add_frames()->mutable_positions()->Resize(2, 0);
                     const auto reader = deformation().DeformTrack(context, request);
                     v1::DeformTrackResponse response;
                     while (reader->Read(&response)) {
                     }
                     return reader->Finish();
                   }});
    all.push_back({"StreamDeform", [this](grpc::ClientContext* context, const Names& names) {
                     const auto stream = deformation().StreamDeform(context);
                     v1::StreamDeformRequest request;
                     request.mutable_open()->set_session_id(names.session);
                     request.mutable_open()->set_handle_set_id(names.set);
                     stream->Write(request);
                     stream->WritesDone();
                     v1::StreamDeformResponse response;
                     while (stream->Read(&response)) {
                     }
                     return stream->Finish();
                   }});
    // Last, the smallest first: for their owner they take away what the others need.
    all.push_back(Unary<v1::DeleteHandleSetRequest, v1::DeleteHandleSetResponse>(
        "DeleteHandleSet", &D::DeleteHandleSet,
        [](auto& request, const Names& names) { request.set_handle_set_id(names.set); }));
    all.push_back(Unary<v1::DeleteMeshRequest, v1::DeleteMeshResponse>(
        "DeleteMesh", &D::DeleteMesh,
        [](auto& request, const Names& names) { request.set_mesh_id(names.mesh); }));
    all.push_back(Unary<v1::DeleteSessionRequest, v1::DeleteSessionResponse>(
        "DeleteSession", &D::DeleteSession, [](auto&, const Names&) {}));
    return all;
  }

  grpc::Status Create(const TestToken& token, const std::string& id) {
    return As(token,
              Unary<v1::CreateSessionRequest, v1::CreateSessionResponse>(
                  "CreateSession", &Deformation::CreateSession, [](auto&, const Names&) {}),
              {id, "", ""});
  }

  const SecretFolder folder_;
  const TestToken alice_{'a', "alice"};
  const TestToken bob_{'b', "bob"};
  const TestToken admin_{'c', "root", "admin"};
};

TEST_F(IsolationTest, WhatBelongsToOthersIsNotThere) {
  ASSERT_TRUE(Create(alice_, "s").ok());
  ASSERT_TRUE(Create(bob_, "own").ok());
  const std::vector<Access> all = Everything();
  // Alice fills her session; what her calls answer shows that each request is a good one.
  for (std::size_t i = 0; i + 3 < all.size(); ++i) {
    EXPECT_TRUE(As(alice_, all[i], {"s", "m", "h"}).ok()) << all[i].rpc;
  }
  for (const TestToken* token : {&bob_, &admin_}) {
    for (const Access& access : all) {
      const grpc::Status foreign = As(*token, access, {"s", "m", "h"});
      const WireError error = ExpectError(foreign, grpc::NOT_FOUND, "NOT_FOUND");
      // Word for word what a session says that nobody has.
      const grpc::Status nobodys = As(*token, access, {"t", "m", "h"});
      std::string expected = nobodys.error_message();
      if (const auto at = expected.find("\"t\""); at != std::string::npos) {
        expected.replace(at, 3, "\"s\"");
      }
      EXPECT_EQ(error.message, expected) << access.rpc;
      EXPECT_EQ(error.metadata.at("id"), "s") << access.rpc;
    }
  }
  // Nor through a session of one's own.
  for (const Access& access : all) {
    const std::string rpc = access.rpc;
    if (rpc.find("Session") != std::string::npos || rpc == "RegisterMesh") continue;
    ExpectError(As(bob_, access, {"own", "m", "h"}), grpc::NOT_FOUND, "NOT_FOUND");
  }
  // It is all still there, and goes when its owner says so.
  for (const Access& access : all) {
    EXPECT_TRUE(As(alice_, access, {"s", "m", "h"}).ok()) << access.rpc;
  }
}

TEST_F(IsolationTest, AdminsSeeAndEndTheSessionsOfOthersByOwner) {
  ASSERT_TRUE(Create(alice_, "s").ok());
  const auto get = [&](const std::string& owner) {
    return Unary<v1::GetSessionRequest, v1::GetSessionResponse>(
        "GetSession", &Deformation::GetSession,
        [owner](auto& request, const Names&) { request.set_owner(owner); });
  };
  const auto end = Unary<v1::DeleteSessionRequest, v1::DeleteSessionResponse>(
      "DeleteSession", &Deformation::DeleteSession,
      [](auto& request, const Names&) { request.set_owner("alice"); });
  const auto list = [&](const TestToken& token, const std::string& owner,
                        v1::ListSessionsResponse* response) {
    grpc::ClientContext context;
    SetDeadline(context);
    context.AddMetadata("authorization", "Bearer " + token.Text());
    v1::ListSessionsRequest request;
    request.set_owner(owner);
    return deformation().ListSessions(&context, request, response);
  };
  v1::ListSessionsResponse page;
  ExpectError(As(bob_, get("alice"), {"s", "", ""}), grpc::NOT_FOUND, "NOT_FOUND");
  ExpectError(As(bob_, end, {"s", "", ""}), grpc::NOT_FOUND, "NOT_FOUND");
  ExpectError(list(bob_, "alice", &page), grpc::NOT_FOUND, "NOT_FOUND");
  EXPECT_TRUE(As(alice_, get("alice"), {"s", "", ""}).ok()) << "one's own name is allowed";
  EXPECT_TRUE(As(admin_, get("alice"), {"s", "", ""}).ok());
  ExpectError(As(admin_, get("bob"), {"s", "", ""}), grpc::NOT_FOUND, "NOT_FOUND");
  ASSERT_TRUE(list(admin_, "alice", &page).ok());
  ASSERT_EQ(page.sessions_size(), 1);
  EXPECT_EQ(page.sessions(0).owner(), "alice");
  EXPECT_TRUE(As(admin_, end, {"s", "", ""}).ok());
  ExpectError(As(alice_, get(""), {"s", "", ""}), grpc::NOT_FOUND, "NOT_FOUND");
}

}  // namespace
}  // namespace arap::wire
