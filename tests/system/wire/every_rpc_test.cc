// Every RPC of a server that wants tokens asks who is calling, but for what is open to all.
#include <string>

#include <gtest/gtest.h>

#include "tests/system/wire/token_fixture.h"
#include "tests/system/wire/wire_fixture.h"

namespace arap::wire {
namespace {

class EveryRpcTest : public WireTest {
 protected:
  EveryRpcTest() {
    folder_.PutTokens({TestToken('a', "alice").Entry()});
    options().credentials.token_file = folder_.tokens();
  }

  const SecretFolder folder_;
};

TEST_F(EveryRpcTest, EveryRpcAsksWhoIsCalling) {
  const auto refused = [](const grpc::Status& status) {
    ExpectError(status, grpc::UNAUTHENTICATED, "UNAUTHENTICATED");
  };
  refused(CreateSession("s"));
  refused(Register("s", "m", Grid(1, 1)));
  refused(Compile("s", "m", "h", {}));
  refused(Deform("s", "h", {}));
  using D = Deformation;
  const auto ask = [&](auto method, auto request, auto response) {
    refused(Call(method, request, &response));
  };
  ask(&D::GetSession, v1::GetSessionRequest(), v1::GetSessionResponse());
  ask(&D::ListSessions, v1::ListSessionsRequest(), v1::ListSessionsResponse());
  ask(&D::DeleteSession, v1::DeleteSessionRequest(), v1::DeleteSessionResponse());
  ask(&D::MeshOutline, v1::MeshOutlineRequest(), v1::MeshOutlineResponse());
  ask(&D::GetMesh, v1::GetMeshRequest(), v1::GetMeshResponse());
  ask(&D::DeleteMesh, v1::DeleteMeshRequest(), v1::DeleteMeshResponse());
  ask(&D::EditHandles, v1::EditHandlesRequest(), v1::EditHandlesResponse());
  ask(&D::GetHandleSet, v1::GetHandleSetRequest(), v1::GetHandleSetResponse());
  ask(&D::DeleteHandleSet, v1::DeleteHandleSetRequest(), v1::DeleteHandleSetResponse());
  const auto ask_flattening = [&](auto method, auto request, auto response) {
    grpc::ClientContext context;
    SetDeadline(context);
    refused((flattening().*method)(&context, request, &response));
  };
  using F = v1::FlatteningService::Stub;
  ask_flattening(&F::Flatten, v1::FlattenRequest(), v1::FlattenResponse());
  ask_flattening(&F::SubmitFlatten, v1::SubmitFlattenRequest(), v1::SubmitFlattenResponse());
  ask_flattening(&F::GetResult, v1::GetResultRequest(), v1::GetResultResponse());
  ask_flattening(&F::CancelJob, v1::CancelJobRequest(), v1::CancelJobResponse());
  const auto read = [&](auto method, auto request, auto response) {
    grpc::ClientContext context;
    SetDeadline(context);
    const auto reader = (flattening().*method)(&context, request);
    EXPECT_FALSE(reader->Read(&response));
    refused(reader->Finish());
  };
  read(&F::WatchJob, v1::WatchJobRequest(), v1::WatchJobResponse());
  read(&F::DownloadResult, v1::DownloadResultRequest(), v1::DownloadResultResponse());
  {
    grpc::ClientContext context;
    SetDeadline(context);
    const auto reader = deformation().DeformTrack(&context, {});
    v1::DeformTrackResponse response;
    EXPECT_FALSE(reader->Read(&response));
    refused(reader->Finish());
  }
  DeformStream stream(deformation());
  EXPECT_FALSE(stream.Read());
  refused(stream.Finish());
  EXPECT_EQ(host().engine().streams.count(), 0u);
}

TEST_F(EveryRpcTest, ServerInfoIsForEverybody) {
  for (const char* header : {"", "Bearer nonsense"}) {
    grpc::ClientContext context;
    SetDeadline(context);
    if (*header != 0) context.AddMetadata("authorization", header);
    v1::GetServerInfoResponse response;
    EXPECT_TRUE(server().GetServerInfo(&context, {}, &response).ok());
  }
}

}  // namespace
}  // namespace arap::wire
