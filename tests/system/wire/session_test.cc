// Sessions over the wire: creation, expiry, ownership of ids, quotas.
#include "tests/system/wire/wire_fixture.h"

namespace arap::wire {
namespace {

using std::chrono::seconds;

class SessionTest : public WireTest {
 protected:
  grpc::Status Get(const std::string& id, v1::GetSessionResponse* response = nullptr) {
    v1::GetSessionRequest request;
    request.set_session_id(id);
    v1::GetSessionResponse ignored;
    return Call(&Deformation::GetSession, request, response ? response : &ignored);
  }

  grpc::Status Delete(const std::string& id) {
    v1::DeleteSessionRequest request;
    request.set_session_id(id);
    v1::DeleteSessionResponse response;
    return Call(&Deformation::DeleteSession, request, &response);
  }

  // Any RPC that uses the session, though it does not find the mesh.
  void Use(const std::string& id) {
    v1::GetMeshRequest request;
    request.set_session_id(id);
    request.set_mesh_id("none");
    v1::GetMeshResponse response;
    ExpectError(Call(&Deformation::GetMesh, request, &response), grpc::NOT_FOUND, "NOT_FOUND");
  }
};

TEST_F(SessionTest, CreateAnswersWhatTheSessionIs) {
  v1::CreateSessionRequest request;
  request.set_session_id("puppet.1");
  request.mutable_ttl()->set_seconds(90);
  (*request.mutable_labels())["user"] = "ann";
  v1::CreateSessionResponse response;
  ASSERT_TRUE(Call(&Deformation::CreateSession, request, &response).ok());
  EXPECT_EQ(response.session().session_id(), "puppet.1");
  EXPECT_EQ(response.session().ttl().seconds(), 90);
  EXPECT_EQ(response.session().labels().at("user"), "ann");
  EXPECT_EQ(response.session().expire_time().seconds(),
            response.session().create_time().seconds() + 90);
}

TEST_F(SessionTest, DefaultTtlIsOneHour) {
  ASSERT_TRUE(CreateSession("s").ok());
  v1::GetSessionResponse response;
  ASSERT_TRUE(Get("s", &response).ok());
  EXPECT_EQ(response.session().ttl().seconds(), 3600);
}

TEST_F(SessionTest, RepeatingCreateIsHarmless) {
  ASSERT_TRUE(CreateSession("s", 60).ok());
  EXPECT_TRUE(CreateSession("s", 60).ok());
  const auto error = ExpectError(CreateSession("s", 61), grpc::ALREADY_EXISTS, "ALREADY_EXISTS");
  EXPECT_EQ(error.metadata.at("id"), "s");
}

TEST_F(SessionTest, IdsHaveRules) {
  for (const std::string& bad : {std::string(), std::string(129, 'a'), std::string("a b"),
                                 std::string("../x"), std::string("ä")}) {
    const auto error = ExpectError(CreateSession(bad), grpc::INVALID_ARGUMENT, "INVALID_NAME");
    EXPECT_EQ(error.fields, std::vector<std::string>{"session_id"});
  }
  EXPECT_TRUE(CreateSession(std::string(128, 'a')).ok());
  EXPECT_TRUE(CreateSession("A-z_0.9").ok());
}

TEST_F(SessionTest, TtlHasRange) {
  for (const std::int64_t bad : {-1, 86'401}) {
    const auto error =
        ExpectError(CreateSession("s", bad), grpc::INVALID_ARGUMENT, "INVALID_OPTION");
    EXPECT_EQ(error.fields, std::vector<std::string>{"ttl"});
  }
  v1::CreateSessionRequest request;
  request.set_session_id("s");
  request.mutable_ttl()->set_nanos(1);
  v1::CreateSessionResponse response;
  ExpectError(Call(&Deformation::CreateSession, request, &response), grpc::INVALID_ARGUMENT,
              "INVALID_OPTION");
  EXPECT_TRUE(CreateSession("s", 86'400).ok());
}

TEST_F(SessionTest, LabelsHaveLimits) {
  v1::CreateSessionRequest request;
  request.set_session_id("s");
  v1::CreateSessionResponse response;
  (*request.mutable_labels())["key"] = std::string(129, 'v');
  ExpectError(Call(&Deformation::CreateSession, request, &response), grpc::INVALID_ARGUMENT,
              "INVALID_OPTION");
  (*request.mutable_labels())["key"] = std::string(128, 'v');
  EXPECT_TRUE(Call(&Deformation::CreateSession, request, &response).ok());
  request.set_session_id("t");
  for (int i = 0; i < 16; ++i) (*request.mutable_labels())["key" + std::to_string(i)] = "";
  const auto error = ExpectError(Call(&Deformation::CreateSession, request, &response),
                                 grpc::INVALID_ARGUMENT, "INVALID_OPTION");
  EXPECT_EQ(error.metadata.at("limit"), "16");
}

TEST_F(SessionTest, UnusedSessionExpires) {
  ASSERT_TRUE(CreateSession("s", 10).ok());
  clock().Advance(seconds(9));
  EXPECT_TRUE(Get("s").ok());
  clock().Advance(seconds(1));
  ExpectError(Get("s"), grpc::NOT_FOUND, "NOT_FOUND");
  EXPECT_TRUE(CreateSession("s", 20).ok()) << "the id of an expired session is free";
}

TEST_F(SessionTest, UseExtendsLifeAndLookingDoesNot) {
  ASSERT_TRUE(CreateSession("s", 10).ok());
  clock().Advance(seconds(6));
  Use("s");
  clock().Advance(seconds(6));
  EXPECT_TRUE(Get("s").ok());
  clock().Advance(seconds(4));
  ExpectError(Get("s"), grpc::NOT_FOUND, "NOT_FOUND");
}

TEST_F(SessionTest, QuotaOfSessionsNamesItselfAndFreesWithExpiry) {
  options().limits.max_sessions = 2;
  ASSERT_TRUE(CreateSession("a", 10).ok());
  ASSERT_TRUE(CreateSession("b", 60).ok());
  const auto error = ExpectError(CreateSession("c"), grpc::RESOURCE_EXHAUSTED, "LIMIT_EXCEEDED");
  EXPECT_EQ(error.metadata.at("quota"), "max_sessions");
  EXPECT_EQ(error.metadata.at("limit"), "2");
  EXPECT_TRUE(CreateSession("b", 60).ok()) << "repeating needs no room";
  clock().Advance(seconds(10));
  EXPECT_TRUE(CreateSession("c").ok());
}

TEST_F(SessionTest, ListGoesPageByPage) {
  for (const char* id : {"c", "a", "d", "b"}) ASSERT_TRUE(CreateSession(id).ok());
  v1::ListSessionsRequest request;
  request.set_page_size(3);
  v1::ListSessionsResponse page;
  ASSERT_TRUE(Call(&Deformation::ListSessions, request, &page).ok());
  ASSERT_EQ(page.sessions_size(), 3);
  EXPECT_EQ(page.sessions(0).session_id(), "a");
  EXPECT_EQ(page.sessions(2).session_id(), "c");
  request.set_page_token(page.next_page_token());
  page.Clear();
  ASSERT_TRUE(Call(&Deformation::ListSessions, request, &page).ok());
  ASSERT_EQ(page.sessions_size(), 1);
  EXPECT_EQ(page.sessions(0).session_id(), "d");
  EXPECT_EQ(page.next_page_token(), "");
}

TEST_F(SessionTest, ListRefusesLargePagesAndForeignTokens) {
  v1::ListSessionsRequest request;
  request.set_page_size(1001);
  v1::ListSessionsResponse page;
  ExpectError(Call(&Deformation::ListSessions, request, &page), grpc::INVALID_ARGUMENT,
              "INVALID_OPTION");
  request.set_page_size(1000);
  EXPECT_TRUE(Call(&Deformation::ListSessions, request, &page).ok());
  request.set_page_token("not a token");
  ExpectError(Call(&Deformation::ListSessions, request, &page), grpc::INVALID_ARGUMENT,
              "INVALID_OPTION");
}

TEST_F(SessionTest, DeletedSessionIsGone) {
  SetUpCorners();
  v1::GetSessionResponse response;
  ASSERT_TRUE(Get("s", &response).ok());
  EXPECT_EQ(response.session().mesh_ids(0), "m");
  EXPECT_EQ(response.session().handle_set_ids(0), "h");
  ASSERT_TRUE(Delete("s").ok());
  ExpectError(Get("s"), grpc::NOT_FOUND, "NOT_FOUND");
  ExpectError(Delete("s"), grpc::NOT_FOUND, "NOT_FOUND");
  ExpectError(Deform("s", "h", {}), grpc::NOT_FOUND, "NOT_FOUND");
}

TEST_F(SessionTest, SessionsDoNotSeeEachOther) {
  SetUpCorners();
  ASSERT_TRUE(CreateSession("t").ok());
  ExpectError(Deform("t", "h", {}), grpc::NOT_FOUND, "NOT_FOUND");
  ExpectError(Compile("t", "m", "h", {}), grpc::NOT_FOUND, "NOT_FOUND");
}

}  // namespace
}  // namespace arap::wire
