// The client library against a private server: sessions, meshes, handles, single shapes.
#include "arap/client/client.h"

#include <optional>
#include <stop_token>

#include <gmock/gmock.h>

#include "tests/cli/server_test.h"

namespace arap::cli {
namespace {

using client::Client;
using client::Session;
using testing::ElementsAre;
using testing::SizeIs;

class ClientLibrary : public ServerTest {};

TEST_F(ClientLibrary, ServerInfo) {
  const auto info = client().GetServerInfo({std::chrono::seconds(10)});
  ASSERT_TRUE(info) << info.error().message;
  EXPECT_NE(info->version, "");
  EXPECT_GT(info->limits.max_ttl.count(), 0);
}

TEST_F(ClientLibrary, SessionsAreMadeListedAndDeleted) {
  const auto session = client().CreateSession({{}, std::chrono::minutes(5), {{"who", "test"}}});
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_THAT(session->id(), SizeIs(32));
  const auto info = session->Get();
  ASSERT_TRUE(info) << info.error().message;
  EXPECT_EQ(info->id, session->id());
  EXPECT_EQ(info->ttl, std::chrono::minutes(5));
  EXPECT_EQ(info->labels.at("who"), "test");
  EXPECT_GT(info->expire_time, info->create_time);

  const auto other = client().CreateSession();
  ASSERT_TRUE(other);
  EXPECT_NE(other->id(), session->id());
  const auto page = client().ListSessions(1);
  ASSERT_TRUE(page) << page.error().message;
  ASSERT_THAT(page->sessions, SizeIs(1));
  const auto next = client().ListSessions(1, page->next_page_token);
  ASSERT_TRUE(next) << next.error().message;
  ASSERT_THAT(next->sessions, SizeIs(1));
  EXPECT_LT(page->sessions[0].id, next->sessions[0].id);

  ASSERT_TRUE(session->Delete());
  const auto gone = client().AttachSession(session->id()).Get();
  ASSERT_FALSE(gone);
  EXPECT_EQ(gone.error().kind, FaultKind::kNotFound);
  EXPECT_EQ(client::DetailOf(gone.error(), client::kGrpcCodeDetail), "NOT_FOUND");
}

TEST_F(ClientLibrary, MeshesAreSharedAndForgotten) {
  const Session session = NewSession();
  const auto first = session.RegisterMesh(Mesh(), {}, "one");
  ASSERT_TRUE(first) << first.error().message;
  EXPECT_EQ(first->mesh.id, "one");
  EXPECT_EQ(first->mesh.report.vertices, Mesh().vertices.size());
  EXPECT_EQ(first->mesh.report.components, 1u);
  EXPECT_DOUBLE_EQ(first->mesh.report.area, 64);
  const auto second = session.RegisterMesh(Mesh(), {}, "two");
  ASSERT_TRUE(second);
  EXPECT_TRUE(second->shared);
  EXPECT_EQ(second->mesh.content_hash, first->mesh.content_hash);
  const auto known = session.GetMesh("two");
  ASSERT_TRUE(known) << known.error().message;
  EXPECT_EQ(known->energy->basis, client::Basis::kEdge);
  EXPECT_EQ(known->energy->weights, client::Weights::kUniform);
  ASSERT_TRUE(session.DeleteMesh("two"));
  EXPECT_EQ(session.GetMesh("two").error().kind, FaultKind::kNotFound);
}

TEST_F(ClientLibrary, HandlesAreCompiledEditedAndForgotten) {
  const Session session = NewSession();
  Compile(session, "set");
  const auto known = session.GetHandleSet("set");
  ASSERT_TRUE(known) << known.error().message;
  EXPECT_EQ(known->mesh_id, "mesh");
  ASSERT_THAT(known->handles, SizeIs(2));
  EXPECT_EQ(known->handles[1].handle.id, "right");
  EXPECT_EQ(known->handles[1].rest, Complex(8, 0));

  client::Handle top{"top", client::PointAnchor{{4, 7.5}}};
  const std::vector<std::string> remove{"left"};
  const auto edited = session.EditHandles("set", remove, std::vector{top});
  ASSERT_TRUE(edited) << edited.error().message;
  ASSERT_THAT(edited->handle_set.handles, SizeIs(2));
  EXPECT_GT(edited->handle_set.revision, known->revision);
  const auto again = session.EditHandles("set", remove, {});
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().kind, FaultKind::kUnknownHandle);

  ASSERT_TRUE(session.DeleteHandleSet("set"));
  EXPECT_EQ(session.GetHandleSet("set").error().kind, FaultKind::kNotFound);
}

TEST_F(ClientLibrary, DeformTranslatesAndRefuses) {
  const Session session = NewSession();
  Compile(session, "set");
  const std::vector<client::HandleTarget> targets{{"left", {{10, 20}}}, {"right", {{18, 20}}}};
  const auto shape = session.Deform("set", targets, {.float64 = true});
  ASSERT_TRUE(shape) << shape.error().message;
  const client::PlanarMesh mesh = Mesh();
  ASSERT_EQ(shape->positions.size(), mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    EXPECT_NEAR(shape->positions[i].real(), mesh.vertices[i].real() + 10, 1e-6);
    EXPECT_NEAR(shape->positions[i].imag(), mesh.vertices[i].imag() + 20, 1e-6);
  }
  EXPECT_EQ(shape->quality.flipped, 0u);
  EXPECT_NEAR(shape->quality.max_stretch, 1, 1e-6);

  const auto too_few = session.Deform("set", std::vector{targets[0]}, {});
  ASSERT_FALSE(too_few);
  EXPECT_EQ(too_few.error().kind, FaultKind::kTargetCount);
  const auto unknown = session.Deform(
      "set", std::vector<client::HandleTarget>{{"left", {{0, 0}}}, {"x", {{0, 0}}}}, {});
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().kind, FaultKind::kUnknownHandle);
}

TEST_F(ClientLibrary, PicksAreAnswered) {
  const Session session = NewSession();
  Compile(session, "set");
  const std::vector<client::HandleTarget> targets{{"left", {{10, 20}}}, {"right", {{18, 20}}}};
  const std::vector<Complex> pick{{14.25, 20.5}, {-50, -50}};
  const auto shape = session.Deform("set", targets, {}, pick);
  ASSERT_TRUE(shape) << shape.error().message;
  ASSERT_THAT(shape->picks, SizeIs(2));
  ASSERT_TRUE(shape->picks[0]);
  EXPECT_NEAR(shape->picks[0]->rest.real(), 4.25, 1e-4);
  EXPECT_NEAR(shape->picks[0]->rest.imag(), 0.5, 1e-4);
  EXPECT_FALSE(shape->picks[1]);
}

TEST_F(ClientLibrary, ATrackCanBeStopped) {
  const Session session = NewSession();
  Compile(session, "set");
  const std::vector<std::string> ids{"right", "left"};  // any order
  const std::vector<std::vector<Target>> frames(20, {{{9, 0}}, {{1, 0}}});
  std::vector<std::uint64_t> seen;
  const Status whole = session.DeformTrack("set", ids, frames, {}, [&](client::Shape&& shape) {
    seen.push_back(shape.sequence);
    EXPECT_NEAR(shape.positions[0].real(), 1, 1e-4);  // vertex 0 is the left handle
    return true;
  });
  ASSERT_TRUE(whole) << whole.error().message;
  EXPECT_THAT(seen, SizeIs(20));
  seen.clear();
  const Status stopped = session.DeformTrack("set", ids, frames, {}, [&](client::Shape&& shape) {
    seen.push_back(shape.sequence);
    return seen.size() < 3;
  });
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, FaultKind::kCancelled);
  EXPECT_THAT(seen, ElementsAre(0, 1, 2));
}

TEST_F(ClientLibrary, FaultsOfMeshesNameTheElements) {
  client::PlanarMesh mesh = Mesh();
  mesh.vertices[3].imag(std::numeric_limits<double>::quiet_NaN());
  const auto registered = NewSession().RegisterMesh(mesh, {});
  ASSERT_FALSE(registered);
  EXPECT_EQ(registered.error().kind, FaultKind::kNonFiniteCoordinate);
  EXPECT_THAT(registered.error().elements, ElementsAre(3));
  EXPECT_NE(registered.error().message, "");
}

TEST_F(ClientLibrary, APassedDeadlineSaysSo) {
  // Well in the past: gRPC rounds deadlines up, and a quick answer may still make one that is now.
  const auto info = client().GetServerInfo({std::chrono::seconds(-1)});
  ASSERT_FALSE(info);
  EXPECT_EQ(info.error().kind, FaultKind::kDeadlineExceeded);
}

TEST_F(ClientLibrary, ACallThatWasStoppedIsCancelled) {
  std::stop_source stop;
  EXPECT_TRUE(client().GetServerInfo({std::nullopt, stop.get_token()}));
  stop.request_stop();
  const auto info = client().GetServerInfo({std::nullopt, stop.get_token()});
  ASSERT_FALSE(info);
  EXPECT_EQ(info.error().kind, FaultKind::kCancelled);
}

TEST(ClientWithoutServer, IsNotReadyAndItsCallsFail) {
  const Client nobody = Client::Connect("unix:/nonexistent/arapd.sock");
  const Status ready = nobody.WaitReady(std::chrono::milliseconds(50));
  ASSERT_FALSE(ready);
  EXPECT_EQ(ready.error().kind, FaultKind::kDeadlineExceeded);
  const auto info = nobody.GetServerInfo();
  ASSERT_FALSE(info);
  EXPECT_EQ(info.error().kind, FaultKind::kDraining);
  EXPECT_EQ(client::DetailOf(info.error(), client::kGrpcCodeDetail), "UNAVAILABLE");
}

}  // namespace
}  // namespace arap::cli
