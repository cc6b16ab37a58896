// Answers that do not fit what was asked: each is refused by the library, and nothing of it is
// handed out.
#include <limits>

#include <gmock/gmock.h>

#include "arap/client/client.h"
#include "arap/v1/deformation_service.pb.h"
#include "arap/v1/flattening_service.pb.h"
#include "tests/support/fake_server.h"

namespace arap::client {
namespace {

using std::chrono::milliseconds;
using testing::FakeServer;
using ::testing::SizeIs;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// A square of two triangles with a handle at two corners.
class AnswersTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(session_.RegisterMesh(mesh_, {}, "m"));
    ASSERT_TRUE(session_.CompileHandles("h", "m", handles_));
  }

  Result<Shape> Deform(const ShapeOptions& options = {}) {
    return session_.Deform("h", targets_, options, picks_);
  }

  // What a stream says to one update and one edit, until it ends.
  Status Stream(const StreamOptions& options = {}) {
    auto stream = session_.OpenStream("h", options);
    if (!stream) return Fail(std::move(stream.error()));
    if (auto sent = stream->Send({7, targets_, {}, picks_}); !sent) return sent;
    if (auto sent = stream->Edit(9, std::vector<std::string>{"a"}, {}); !sent) return sent;
    if (auto sent = stream->CloseSending(); !sent) return sent;
    for (;;) {
      auto event = stream->Read();
      if (!event) return Fail(std::move(event.error()));
      if (!*event) return {};
    }
  }

  // A track of two frames; counts what is handed out.
  Status Track() {
    const std::vector<std::vector<Target>> frames(2, std::vector<Target>(2));
    const std::vector<std::string> ids{"a", "b"};
    frames_ = 0;
    return session_.DeformTrack("h", ids, frames, {}, [&](Shape&& shape) {
      EXPECT_THAT(shape.positions, SizeIs(4));
      ++frames_;
      return true;
    });
  }

  // Every call that answers shapes refuses this one.
  void ExpectRefused(const char* what, std::function<void(v1::Shape&)> change) {
    server_.Change<v1::Shape>(std::move(change));
    const auto shape = Deform();
    ASSERT_FALSE(shape) << what;
    EXPECT_EQ(shape.error().kind, FaultKind::kInternal) << what;
    EXPECT_THAT(shape.error().message, ::testing::StartsWith("The server answered")) << what;
    const Status streamed = Stream();
    ASSERT_FALSE(streamed) << what;
    EXPECT_EQ(streamed.error().message, shape.error().message);
    EXPECT_FALSE(Track()) << what;
    EXPECT_EQ(frames_, 0) << what;
  }

  template <class Answer>
  void Change(std::function<void(Answer&)> change) {
    server_.Change<Answer>(std::move(change));
  }

  FakeServer server_;
  Client client_ = Client::Connect(server_.address());
  Session session_ = client_.AttachSession("s");
  const PlanarMesh mesh_{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {{0, 1, 2}, {0, 2, 3}}};
  const std::vector<Handle> handles_{{"a", VertexAnchor{0}}, {"b", VertexAnchor{2}}};
  const std::vector<HandleTarget> targets_{{"a", {{1, 2}}}, {"b", {{3, 4}}}};
  const std::vector<Complex> picks_{{0.5, 0.5}};
  int frames_ = 0;
};

TEST_F(AnswersTest, OfAnHonestServerAreTaken) {
  const auto shape = Deform({.float64 = true, .flipped_ids = true});
  ASSERT_TRUE(shape) << shape.error().message;
  EXPECT_EQ(shape->positions, mesh_.vertices);
  EXPECT_THAT(shape->picks, SizeIs(1));
  const Status stream = Stream({.delivery = Delivery::kEvery});
  EXPECT_TRUE(stream) << stream.error().message;
  const Status latest = Stream();
  EXPECT_TRUE(latest) << latest.error().message;
  const Status track = Track();
  EXPECT_TRUE(track) << track.error().message;
  EXPECT_EQ(frames_, 2);
  EXPECT_TRUE(session_.EditHandles("h", std::vector<std::string>{"a", "b"}, handles_));
  EXPECT_TRUE(session_.GetHandleSet("h"));
  EXPECT_TRUE(client_.CreateSession());
  EXPECT_TRUE(session_.Get());
  EXPECT_TRUE(client_.ListSessions());
}

TEST_F(AnswersTest, ShapesFitTheMesh) {
  ExpectRefused("empty", [](v1::Shape& shape) { shape.clear_positions(); });
  ExpectRefused("short", [](v1::Shape& shape) { shape.mutable_positions()->Truncate(6); });
  ExpectRefused("odd", [](v1::Shape& shape) { shape.mutable_positions()->Truncate(7); });
  ExpectRefused("long", [](v1::Shape& shape) { shape.mutable_positions()->Resize(10, 0); });
  EXPECT_EQ(Deform().error().message, "The server answered a shape of 5 vertices; the mesh has 4.");
  ExpectRefused("infinite", [](v1::Shape& shape) { shape.set_positions(3, kInfinity); });
  ExpectRefused("no number", [](v1::Shape& shape) { shape.set_positions(2, kNan); });
  EXPECT_THAT(Deform().error().message, ::testing::HasSubstr("not finite"));
  ExpectRefused("in double precision", [](v1::Shape& shape) { shape.add_positions64(1); });
  ExpectRefused("a quality of NaN", [](v1::Shape& shape) { shape.set_energy(kNan); });
  ExpectRefused("a strange name", [](v1::Shape& shape) { shape.set_worst_handle_id("\x1b[2J"); });
  ExpectRefused("ids that were not asked", [](v1::Shape& shape) { shape.add_flipped_ids(0); });
  ExpectRefused("unmeasured", [](v1::Shape& shape) { shape.set_unmeasured(true); });
}

TEST_F(AnswersTest, PicksAreAsManyAsWereAskedAndOnTheMesh) {
  const auto refused = [&](auto change) {
    server_.Change<v1::Shape>(change);
    return !Deform() && !Stream();
  };
  EXPECT_TRUE(refused([](v1::Shape& shape) { shape.clear_picks(); }));
  EXPECT_TRUE(refused([](v1::Shape& shape) { shape.add_picks(); }));
  EXPECT_TRUE(refused([](v1::Shape& shape) {
    if (shape.picks_size() > 0) shape.mutable_picks(0)->set_hit(true);
  }));
  EXPECT_TRUE(refused([](v1::Shape& shape) {
    if (shape.picks_size() == 0) return;
    v1::PickResult& pick = *shape.mutable_picks(0);
    pick.set_hit(true);
    pick.set_triangle(2);
    for (int k = 0; k < 3; ++k) pick.add_barycentric(1.0 / 3);
  }));
}

TEST_F(AnswersTest, TracksHaveTheFramesThatWereAsked) {
  server_.AnswerFrames(std::numeric_limits<std::uint64_t>::max());
  const Status endless = Track();
  ASSERT_FALSE(endless);
  EXPECT_EQ(endless.error().message, "The server answered more frames than the 2 of the track.");
  EXPECT_EQ(frames_, 2);
  server_.AnswerFrames(1);
  const Status brief = Track();
  ASSERT_FALSE(brief);
  EXPECT_EQ(brief.error().message, "The server ended the track after 1 of 2 frames.");
  server_.AnswerFrames(2);
  Change<v1::Shape>([](v1::Shape& shape) { shape.set_sequence(1); });
  const Status again = Track();
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().message, "The server answered frame 1 of the track where 0 was due.");
  EXPECT_EQ(frames_, 0);
}

TEST_F(AnswersTest, StreamsAreAnsweredWhatTheyWereAsked) {
  using Response = v1::StreamDeformResponse;
  const auto refused = [&](auto change) {
    Change<Response>(change);
    const Status ended = Stream({.delivery = Delivery::kEvery});
    EXPECT_EQ(ended ? FaultKind::kCancelled : ended.error().kind, FaultKind::kInternal);
    return ended ? std::string() : ended.error().message;
  };
  EXPECT_EQ(refused([](Response& response) {
              if (response.has_shape()) response.mutable_shape()->set_sequence(8);
            }),
            "The server answered the sequence 8, for which it was not asked.");
  EXPECT_EQ(refused([](Response& response) {
              if (response.has_shape()) response.mutable_shape()->set_sequence(9);
            }),
            "The server answered the sequence 9, for which it was not asked.")
      << "of every update, in their order";
  EXPECT_EQ(refused([](Response& response) {
              if (response.has_shape()) response.mutable_error()->set_sequence(1);
            }),
            "The server answered the sequence 1, for which it was not asked.");
  EXPECT_EQ(refused([](Response& response) {
              if (response.has_shape()) response.mutable_pong()->set_nonce(1);
            }),
            "The server answered a ping that was not sent.");
  EXPECT_EQ(refused([](Response& response) {
              if (response.has_opened()) {
                response.mutable_opened()->mutable_handle_set()->set_handle_set_id("other");
              }
            }),
            "The server answered the handle set \"other\", not \"h\".");
}

TEST_F(AnswersTest, ShapesOfAnUnknownMeshHaveOneSizeInAStream) {
  auto stream = client_.AttachSession("s").OpenStream("h");
  ASSERT_TRUE(stream) << stream.error().message;
  ASSERT_TRUE(stream->Send({1, targets_, {}, {}}));
  ASSERT_TRUE(stream->Read());
  Change<v1::Shape>([](v1::Shape& shape) { shape.mutable_positions()->Truncate(6); });
  ASSERT_TRUE(stream->Send({2, targets_, {}, {}}));
  EXPECT_FALSE(stream->Read());
}

TEST_F(AnswersTest, AServerThatAnswersOnlyPingsIsGivenUp) {
  server_.AnswerOnlyPings();
  auto stream =
      session_.OpenStream("h", {.heartbeat = milliseconds(20), .answer = milliseconds(200)});
  ASSERT_TRUE(stream) << stream.error().message;
  ASSERT_TRUE(stream->Send({1, targets_, {}, {}}));
  const auto event = stream->Read();
  ASSERT_FALSE(event);
  EXPECT_EQ(event.error().kind, FaultKind::kDeadlineExceeded);
  EXPECT_EQ(event.error().message, "The server has not answered an update or edit for 0.2 s.");
}

TEST_F(AnswersTest, AStreamThatEndsBeforeItsAnswersHasNotEndedWell) {
  server_.AnswerOnlyPings();
  const Status ended = Stream();
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().kind, FaultKind::kInternal);
  EXPECT_EQ(ended.error().message,
            "The server ended the stream early: what was sent on it has no answer.");
}

TEST_F(AnswersTest, ASilentServerIsGivenUpAlsoWithoutAHeartbeat) {
  server_.Hush("StreamDeform");
  const Status ended = Stream({.heartbeat = milliseconds(0), .answer = milliseconds(200)});
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().kind, FaultKind::kDeadlineExceeded);
  EXPECT_EQ(ended.error().message, "The server has not opened the stream for 0.2 s.");
}

TEST_F(AnswersTest, HandleSetsHaveTheHandlesThatWereSent) {
  const auto compile = [&] { return session_.CompileHandles("h", "m", handles_); };
  const auto refused = [&](auto change) {
    Change<v1::CompileHandlesResponse>(
        [change](v1::CompileHandlesResponse& answer) { change(*answer.mutable_handle_set()); });
    return !compile();
  };
  EXPECT_TRUE(refused([](v1::HandleSetInfo& set) { set.clear_handles(); }));
  EXPECT_TRUE(refused([](v1::HandleSetInfo& set) { set.add_handles()->set_handle_id("c"); }));
  EXPECT_TRUE(refused([](v1::HandleSetInfo& set) { set.mutable_handles()->SwapElements(0, 1); }));
  EXPECT_TRUE(
      refused([](v1::HandleSetInfo& set) { set.mutable_handles(1)->mutable_rest()->set_x(kNan); }));
  EXPECT_TRUE(refused([](v1::HandleSetInfo& set) { set.set_mesh_id("other"); }));
  EXPECT_TRUE(refused([](v1::HandleSetInfo& set) { set.add_depth(1); }));
  EXPECT_TRUE(refused([](v1::HandleSetInfo& set) {
    for (int i = 0; i < 2; ++i) set.add_draw_order(1);
  }));
  Change<v1::CompileHandlesResponse>([](v1::CompileHandlesResponse& answer) {
    for (const std::uint32_t t : {1u, 0u}) answer.mutable_handle_set()->add_draw_order(t);
  });
  EXPECT_TRUE(compile());
}

TEST_F(AnswersTest, MeshesAreThoseThatWereSent) {
  const auto refused = [&](auto change) {
    Change<v1::RegisterMeshResponse>(
        [change](v1::RegisterMeshResponse& answer) { change(*answer.mutable_mesh()); });
    return !session_.RegisterMesh(mesh_, {}, "m");
  };
  EXPECT_TRUE(refused([](v1::MeshInfo& mesh) { mesh.set_vertex_count(5); }));
  EXPECT_TRUE(refused([](v1::MeshInfo& mesh) { mesh.set_triangle_count(0); }));
  EXPECT_TRUE(refused([](v1::MeshInfo& mesh) { mesh.set_mesh_id("other"); }));
  EXPECT_TRUE(refused([](v1::MeshInfo& mesh) { mesh.set_area(kNan); }));
}

TEST_F(AnswersTest, MeshesOfOutlinesAreMeshes) {
  const std::vector<Outline> outlines{{{0, 0}, {1, 0}, {0, 1}}};
  const auto refused = [&](auto change) {
    Change<v1::MeshOutlineResponse>(
        [change](v1::MeshOutlineResponse& answer) { change(*answer.mutable_mesh()); });
    const auto answer = client_.MeshOutline(outlines);
    return !answer && answer.error().kind == FaultKind::kInternal;
  };
  EXPECT_FALSE(refused([](v1::PlanarMesh&) {}));
  EXPECT_TRUE(refused([](v1::PlanarMesh& mesh) { mesh.add_vertices(5); }));
  EXPECT_TRUE(refused([](v1::PlanarMesh& mesh) { mesh.add_triangles(0); }));
  EXPECT_TRUE(refused([](v1::PlanarMesh& mesh) { mesh.set_vertices(0, kNan); }));
  EXPECT_TRUE(refused([](v1::PlanarMesh& mesh) { mesh.set_triangles(0, 3); }));
  EXPECT_TRUE(refused([](v1::PlanarMesh& mesh) { mesh.set_triangles(0, 1); }));
  EXPECT_TRUE(refused([](v1::PlanarMesh& mesh) { mesh.mutable_triangles()->SwapElements(0, 1); }));
}

TEST_F(AnswersTest, OptionsOfANewerServerAreNoFault) {
  Change<v1::RegisterMeshResponse>([](v1::RegisterMeshResponse& answer) {
    answer.mutable_mesh()->mutable_energy()->set_basis(static_cast<v1::Basis>(77));
  });
  const auto registration = session_.RegisterMesh(mesh_, {}, "m");
  ASSERT_TRUE(registration) << registration.error().message;
  EXPECT_FALSE(registration->mesh.energy);
}

TEST_F(AnswersTest, PagesOfSessionsEnd) {
  const auto refused = [&](auto change) {
    Change<v1::ListSessionsResponse>(change);
    return !client_.ListSessions(2, "token");
  };
  EXPECT_TRUE(refused([](v1::ListSessionsResponse& page) { page.set_next_page_token("token"); }));
  EXPECT_TRUE(refused([](v1::ListSessionsResponse& page) {
    for (int i = 0; i < 2; ++i) page.add_sessions()->set_session_id("t");
  }));
  EXPECT_TRUE(refused([](v1::ListSessionsResponse& page) {
    page.mutable_sessions(0)->set_session_id("two words");
  }));
}

TEST_F(AnswersTest, TimesBeyondAllMeasureAreNoOverflow) {
  Change<v1::GetSessionResponse>([](v1::GetSessionResponse& answer) {
    v1::Session& session = *answer.mutable_session();
    session.mutable_ttl()->set_seconds(std::numeric_limits<std::int64_t>::max());
    session.mutable_create_time()->set_seconds(std::numeric_limits<std::int64_t>::min());
  });
  EXPECT_TRUE(session_.Get());
}

TEST_F(AnswersTest, LayoutsFitTheSurface) {
  const SurfaceMesh surface{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  const FlattenQuery query{.first_step = true, .singular_values = true};
  EXPECT_TRUE(client_.Flatten(surface, query));
  using Response = v1::FlattenResponse;
  const auto refused = [&](auto change) {
    Change<Response>(change);
    return !client_.Flatten(surface, query);
  };
  EXPECT_TRUE(refused([](Response& flat) { flat.Clear(); }));
  EXPECT_TRUE(refused([](Response& flat) { flat.mutable_uv()->Truncate(4); }));
  EXPECT_TRUE(refused([](Response& flat) { flat.set_uv(0, kInfinity); }));
  EXPECT_TRUE(refused([](Response& flat) { flat.set_uv(0, kNan); }));
  EXPECT_TRUE(refused([](Response& flat) { flat.add_uv64(1); }));
  EXPECT_TRUE(refused([](Response& flat) { flat.set_uv_vertex(1, 2); }));
  EXPECT_TRUE(refused([](Response& flat) { flat.set_uv_vertex(0, 3); }));
  EXPECT_TRUE(refused([](Response& flat) { flat.set_corner_uv(1, 3); }));
  EXPECT_TRUE(refused([](Response& flat) { flat.clear_corner_uv(); }));
  EXPECT_TRUE(refused([](Response& flat) { flat.mutable_corner_uv()->SwapElements(0, 1); }));
  EXPECT_TRUE(refused([](Response& flat) { flat.clear_first_step_uv(); }));
  EXPECT_TRUE(refused([](Response& flat) { flat.clear_singular_values(); }));
  EXPECT_TRUE(refused([](Response& flat) { flat.clear_charts(); }));
  EXPECT_TRUE(refused([](Response& flat) { flat.clear_triangle_chart(); }));
  EXPECT_TRUE(refused([](Response& flat) { flat.set_triangle_chart(0, 1); }));
  EXPECT_TRUE(refused(
      [](Response& flat) { flat.mutable_charts(0)->mutable_loops(0)->set_uv_indices(0, 9); }));
  EXPECT_TRUE(refused([](Response& flat) { flat.mutable_charts(0)->add_anchors(3); }));
  EXPECT_TRUE(refused([](Response& flat) { flat.mutable_charts(0)->set_triangle_count(2); }));
  EXPECT_TRUE(refused([](Response& flat) { flat.mutable_charts(0)->set_refinements(~0u); }));
  EXPECT_TRUE(refused([](Response& flat) {
    for (int i = 0; i < 2; ++i) flat.add_cut_edges(3);
  }));
  EXPECT_TRUE(refused([](Response& flat) { flat.set_auto_cut_count(1); }));
  EXPECT_TRUE(refused([](Response& flat) { flat.add_left_out_triangles(1); }));
  EXPECT_TRUE(refused([](Response& flat) { flat.mutable_distortion()->set_arap_energy(kNan); }));
}

TEST_F(AnswersTest, DrawingsAreThoseThatWereAsked) {
  const SurfaceMesh surface{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  FlattenQuery query{.first_step = true, .singular_values = true};
  query.drawings = {{.format = DrawingFormat::kPdf}, {.paper = "A4"}};
  using Response = v1::FlattenResponse;
  const auto answered = [&](auto change) {
    Change<Response>([&](Response& flat) {
      flat.add_drawings()->add_files()->set_data("%PDF");
      for (const char* page : {"cover", "1", "12"}) {
        v1::DrawingFile& file =
            *(flat.drawings_size() < 2 ? flat.add_drawings() : flat.mutable_drawings(1))
                 ->add_files();
        file.set_page(page);
        file.set_data("<svg/>");
      }
      change(flat);
    });
    return client_.Flatten(surface, query).has_value();
  };
  EXPECT_TRUE(answered([](Response&) {}));
  EXPECT_FALSE(answered([](Response& flat) { flat.clear_drawings(); }));
  EXPECT_FALSE(answered([](Response& flat) { flat.add_drawings(); }));
  EXPECT_FALSE(answered([](Response& flat) { flat.mutable_drawings(0)->clear_files(); }));
  EXPECT_FALSE(answered([](Response& flat) { flat.mutable_drawings(0)->add_files(); }));
  EXPECT_FALSE(
      answered([](Response& flat) { flat.mutable_drawings(0)->mutable_files(0)->set_page("1"); }));
  EXPECT_FALSE(
      answered([](Response& flat) { flat.mutable_drawings(0)->mutable_files(0)->clear_data(); }));
  EXPECT_FALSE(answered(
      [](Response& flat) { flat.mutable_drawings(1)->mutable_files(1)->set_page("../1"); }));
}

}  // namespace
}  // namespace arap::client
