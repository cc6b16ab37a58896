// EchoService: there only when asked for, and bytes for bytes.
#include <memory>

#include <arap/v1/echo_service.grpc.pb.h>
#include <gtest/gtest.h>

#include "tests/system/wire/token_fixture.h"
#include "tests/system/wire/wire_fixture.h"

namespace arap::wire {
namespace {

class EchoTest : public WireTest {
 protected:
  using Call = grpc::ClientReaderWriter<v1::EchoRequest, v1::EchoResponse>;

  EchoTest() { options().echo = true; }

  std::unique_ptr<Call> Open(grpc::ClientContext& context) {
    SetDeadline(context);
    channel_ = grpc::CreateChannel(host().addresses().front(), grpc::InsecureChannelCredentials());
    stub_ = v1::EchoService::NewStub(channel_);
    return stub_->Echo(&context);
  }

  static v1::EchoRequest Asking(std::uint32_t bytes) {
    v1::EchoRequest request;
    request.set_payload("some bytes");
    request.set_answer_bytes(bytes);
    return request;
  }

 private:
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<v1::EchoService::Stub> stub_;
};

TEST_F(EchoTest, AnswersEveryMessageInOrderWithAsManyBytesAsItAsksFor) {
  grpc::ClientContext context;
  const auto call = Open(context);
  for (const std::uint32_t bytes : {3u, 100'000u, 0u, 7u}) EXPECT_TRUE(call->Write(Asking(bytes)));
  EXPECT_TRUE(call->WritesDone());
  v1::EchoResponse response;
  for (const std::size_t bytes : {3u, 100'000u, 0u, 7u}) {
    ASSERT_TRUE(call->Read(&response));
    EXPECT_EQ(response.payload().size(), bytes);
  }
  EXPECT_FALSE(call->Read(&response));
  EXPECT_TRUE(call->Finish().ok());
}

TEST_F(EchoTest, BoundsWhatIsAskedFor) {
  options().limits.max_message_bytes = 1'000'000;
  grpc::ClientContext context;
  const auto call = Open(context);
  EXPECT_TRUE(call->Write(Asking(1'000'001)));
  v1::EchoResponse response;
  EXPECT_FALSE(call->Read(&response));
  EXPECT_EQ(call->Finish().error_code(), grpc::RESOURCE_EXHAUSTED);
}

TEST_F(EchoTest, CountsAsAStreamAndEndsWhenTheServerDrains) {
  grpc::ClientContext context;
  const auto call = Open(context);
  EXPECT_TRUE(call->Write(Asking(1)));
  v1::EchoResponse response;
  EXPECT_TRUE(call->Read(&response));
  EXPECT_EQ(host().engine().streams.count(), 1u);
  host().engine().streams.Drain();
  EXPECT_FALSE(call->Read(&response));
  ExpectError(call->Finish(), grpc::UNAVAILABLE, "DRAINING");
}

TEST_F(EchoTest, IsNotThereUnlessItWasAskedFor) {
  options().echo = false;
  grpc::ClientContext context;
  const auto call = Open(context);
  v1::EchoResponse response;
  EXPECT_FALSE(call->Read(&response));
  EXPECT_EQ(call->Finish().error_code(), grpc::UNIMPLEMENTED);
}

TEST_F(EchoTest, AsksWhoIsCalling) {
  const SecretFolder folder;
  folder.PutTokens({TestToken('a', "alice").Entry()});
  options().credentials.token_file = folder.tokens();
  grpc::ClientContext context;
  const auto call = Open(context);
  v1::EchoResponse response;
  EXPECT_FALSE(call->Read(&response));
  ExpectError(call->Finish(), grpc::UNAUTHENTICATED, "UNAUTHENTICATED");
}

}  // namespace
}  // namespace arap::wire
