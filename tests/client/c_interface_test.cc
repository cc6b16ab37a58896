// The interface for C: a program in C against the real arapd, and every kind of fault.
#include <new>
#include <span>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>

#include "arap/c/arap_c.h"
#include "client/c/guard.h"
#include "proto/convert/status.h"
#include "tests/client/c_calls.h"
#include "tests/support/fake_server.h"
#include "tests/system/fault/server_process.h"

namespace arap::c {
namespace {

using ::testing::ElementsAre;
using testing::FakeServer;

class ProgramInC : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(server_.Start()); }
  const char* address() const { return server_.address().c_str(); }

 private:
  fault::ServerProcess server_;
};

TEST_F(ProgramInC, Drags) { EXPECT_STREQ(CDrag(address()), nullptr); }
TEST_F(ProgramInC, EditsAndCancels) { EXPECT_STREQ(CEdits(address()), nullptr); }
TEST_F(ProgramInC, Picks) { EXPECT_STREQ(CPicks(address()), nullptr); }
TEST_F(ProgramInC, PlaysTracks) { EXPECT_STREQ(CTracks(address()), nullptr); }
TEST_F(ProgramInC, MeshesOutlines) { EXPECT_STREQ(COutlines(address()), nullptr); }
TEST_F(ProgramInC, Draws) { EXPECT_STREQ(CDrawings(address()), nullptr); }
TEST_F(ProgramInC, HasJobs) { EXPECT_STREQ(CJobs(address()), nullptr); }
TEST_F(ProgramInC, Flattens) { EXPECT_STREQ(CFlatten(address()), nullptr); }
TEST_F(ProgramInC, IsToldWhatIsWrong) { EXPECT_STREQ(CRefusals(address()), nullptr); }
TEST(ProgramInCWithoutServer, IsToldWhatIsWrong) { EXPECT_STREQ(CBadArguments(), nullptr); }

TEST(CInterface, EveryKindOfFaultArrives) {
  FakeServer server;
  arap_client* client = nullptr;
  ASSERT_EQ(arap_connect(server.address().c_str(), nullptr, &client), nullptr);
  arap_call_options once{};
  once.size = sizeof(once);
  once.retry_ms = -1;
  for (const FaultInfo& info : FaultTable()) {
    SCOPED_TRACE(info.reason);
    Fault fault = Fault(info.kind, "What is wrong.").Field("mesh.vertices").Detail("limit", 7);
    fault.Elements({3, 5});
    server.Refuse("CreateSession", {convert::ToGrpcStatus(fault)});
    arap_session* session = nullptr;
    arap_error* error = arap_create_session(client, nullptr, 0, &once, &session);
    ASSERT_NE(error, nullptr);
    EXPECT_EQ(session, nullptr);
    EXPECT_EQ(arap_error_reason(error), info.reason);
    EXPECT_STREQ(arap_error_message(error), "What is wrong.");
    EXPECT_EQ(arap_error_code(error), static_cast<int>(info.code));
    EXPECT_STREQ(arap_error_detail(error, "limit"), "7");
    EXPECT_THAT(std::span(arap_error_elements(error), arap_error_element_count(error)),
                ElementsAre(3, 5));
    EXPECT_EQ(arap_error_retry_ms(error) != 0, info.retry.count() != 0);
    arap_error_free(error);
  }
  arap_client_free(client);
}

TEST(CInterface, WhatIsThrownInsideIsAnError) {
  // Made without memory, and freed as often as it is answered.
  for (int i = 0; i < 2; ++i) {
    arap_error* error = Guard([]() -> Status { throw std::bad_alloc(); });
    ASSERT_NE(error, nullptr);
    EXPECT_STREQ(arap_error_reason(error), "OUT_OF_MEMORY");
    arap_error_free(error);
  }
  arap_error* error = Guard([]() -> Status { throw std::runtime_error("of a library"); });
  ASSERT_NE(error, nullptr);
  EXPECT_STREQ(arap_error_reason(error), "INTERNAL");
  EXPECT_STREQ(arap_error_message(error), "of a library");
  arap_error_free(error);
}

}  // namespace
}  // namespace arap::c
