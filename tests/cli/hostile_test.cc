// arapctl against servers that answer wrongly, without end, or not at all: it says so, ends with 1,
// and leaves neither a file that looks like a result nor anything that a terminal obeys.
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <utility>

#include <gmock/gmock.h>

#include "client/cli/sample/samples.h"
#include "core/files/mesh_file.h"
#include "core/files/obj_writer.h"
#include "core/files/track.h"
#include "tests/cli/hostile_server.h"
#include "tests/cli/run.h"

namespace arap::cli {
namespace {

using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;

constexpr std::uint64_t kFrames = 60;
const char* const kEscapes = "\x1b]0;owned\x07\x1b[2J\x9b";

// Something that may be wrong with the shape of a frame.
struct Wrong {
  std::string name;
  std::function<void(v1::Shape&)> spoil;
};

std::vector<Wrong> WrongShapes() {
  return {{"Empty", [](v1::Shape& shape) { shape.clear_positions64(); }},
          {"Short", [](v1::Shape& shape) { shape.mutable_positions64()->Truncate(4); }},
          {"Odd", [](v1::Shape& shape) { shape.mutable_positions64()->RemoveLast(); }},
          {"Long", [](v1::Shape& shape) { shape.mutable_positions64()->Resize(1000, 1); }},
          {"NaN", [](v1::Shape& shape) { shape.set_positions64(3, NAN); }},
          {"Infinite", [](v1::Shape& shape) { shape.set_positions64(0, INFINITY); }},
          {"Late", [](v1::Shape& shape) { shape.set_sequence(shape.sequence() + 1); }},
          {"FarAway",
           [](v1::Shape& shape) { shape.set_sequence(std::numeric_limits<std::uint64_t>::max()); }},
          {"AnotherPick", [](v1::Shape& shape) { shape.add_picks(); }}};
}

class Hostile : public FolderTest {
 protected:
  void SetUp() override {
    const PlanarMesh mesh = MakeGrid(3, 3);
    Put("grid.obj", FormatObj(mesh));
    Put("grid.json", FormatTrack(MakeGridTrack(mesh, 3, 3)));
    Put("square.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n");
  }

  void Serve(HostileServer::Script script) {
    server_ = std::make_unique<HostileServer>(std::move(script));
  }
  const HostileServer& server() const { return *server_; }

  Outcome Run(const std::string& command, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{command};
    if (command == "bake" || command == "drag") {
      words.insert(words.end(), {Path("grid.obj"), Path("grid.json"), "--out", Path("out.csv"),
                                 "--svg", Path("out.svg"), "--frames-svg", Path("frames.svg")});
    }
    words.insert(words.end(), {"--server", server_->address()});
    words.insert(words.end(), more.begin(), more.end());
    return Arapctl(words);
  }

  Outcome Flatten(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{Path("square.obj"), "--out", Path("out.obj"), "--svg",
                                   Path("out.svg"),    "--dxf", Path("out.dxf")};
    words.insert(words.end(), more.begin(), more.end());
    return Run("flatten", words);
  }

  // An exit code of a fault, a sentence, and no file but those of SetUp.
  void ExpectRefused(const Outcome& outcome) const {
    EXPECT_GE(outcome.code, 3) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("arapctl: "));
    ExpectClean(outcome);
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(Path(""))) {
      ++files;
      EXPECT_THAT(entry.path().filename().string(), AnyOf("grid.obj", "grid.json", "square.obj"));
    }
    EXPECT_EQ(files, 3u);
  }

  static void ExpectClean(const Outcome& outcome) {
    for (const std::string& text : {outcome.out, outcome.err}) {
      EXPECT_THAT(text,
                  AllOf(Not(HasSubstr("\x1b")), Not(HasSubstr("\x07")), Not(HasSubstr("\x9b"))));
    }
  }

 private:
  std::unique_ptr<HostileServer> server_;
};

TEST_F(Hostile, OneThatIsNotIsServed) {
  Serve({});
  for (const char* command : {"bake", "drag"}) {
    const Outcome outcome = Run(command);
    EXPECT_EQ(outcome.code, 0) << command << ": " << outcome.err;
    EXPECT_EQ(ParseCsv(Slurp(Path("out.csv"))).header.substr(0, 11), "frame,x0,y0");
  }
}

class HostileShape : public Hostile, public testing::WithParamInterface<Wrong> {
 protected:
  v1::Shape Spoilt(std::uint64_t sequence) const {
    v1::Shape shape = server().Shape(sequence);
    GetParam().spoil(shape);
    return shape;
  }
};

TEST_P(HostileShape, InATrackIsRefused) {
  // The tenth is wrong: by then there is something on the disk.
  Serve({.track = [this](const auto& request, HostileServer::Track& track) {
    for (int i = 0; i < request.frames_size(); ++i) {
      const auto sequence = static_cast<std::uint64_t>(i);
      v1::DeformTrackResponse response;
      *response.mutable_shape() = i == 10 ? Spoilt(sequence) : server().Shape(sequence);
      track.Write(response);
    }
    return grpc::Status::OK;
  }});
  ExpectRefused(Run("bake"));
}

TEST_P(HostileShape, InAStreamIsRefused) {
  Serve({.stream = [this](HostileServer::Stream& stream) {
    for (v1::StreamDeformRequest request; stream.Read(&request);) {
      if (!request.has_update()) continue;
      v1::StreamDeformResponse response;
      const std::uint64_t sequence = request.update().sequence();
      *response.mutable_shape() = sequence > 20 ? Spoilt(sequence) : server().Shape(sequence);
      stream.Write(response);
    }
    return grpc::Status::OK;
  }});
  ExpectRefused(Run("drag", {"--delivery", "every"}));
  ExpectRefused(Run("drag", {"--rate", "10000"}));
}

INSTANTIATE_TEST_SUITE_P(All, HostileShape, testing::ValuesIn(WrongShapes()),
                         [](const auto& wrong) { return wrong.param.name; });

TEST_F(Hostile, AFigureOfAnEmptyShapeIsRefused) {
  Serve({.deform = [](v1::DeformResponse& response) {
    response.mutable_shape()->clear_positions64();
    return grpc::Status::OK;
  }});
  ExpectRefused(Run("figures", {"--out", Path("")}));
}

TEST_F(Hostile, ATrackWithoutEndEndsAfterItsFrames) {
  Serve({.track = [this](const auto&, HostileServer::Track& track) {
    v1::DeformTrackResponse response;
    for (std::uint64_t i = 0;; ++i) {
      *response.mutable_shape() = server().Shape(i);
      if (!track.Write(response)) return grpc::Status::CANCELLED;
    }
  }});
  ExpectRefused(Run("bake"));
}

TEST_F(Hostile, ATrackThatEndsEarlyIsRefused) {
  Serve({.track = [this](const auto&, HostileServer::Track& track) {
    v1::DeformTrackResponse response;
    for (std::uint64_t i = 0; i + 1 < kFrames; ++i) {
      *response.mutable_shape() = server().Shape(i);
      track.Write(response);
    }
    return grpc::Status::OK;
  }});
  ExpectRefused(Run("bake"));
}

TEST_F(Hostile, AStreamThatAnswersOneUpdateForEverIsLeft) {
  Serve({.stream = [this](HostileServer::Stream& stream) {
    v1::StreamDeformRequest request;
    while (stream.Read(&request) && !request.has_update()) {
    }
    v1::StreamDeformResponse response;
    *response.mutable_shape() = server().Shape(request.update().sequence());
    while (stream.Write(response)) {
    }
    return grpc::Status::OK;
  }});
  ExpectRefused(Run("drag"));
  ExpectRefused(Run("drag", {"--delivery", "every"}));
}

TEST_F(Hostile, AStreamThatEndsWithoutItsAnswersIsRefused) {
  Serve({.stream = [](HostileServer::Stream& stream) {
    // Two sequences for each frame.
    for (v1::StreamDeformRequest request;
         stream.Read(&request) && request.update().sequence() < 2 * kFrames;) {
    }
    return grpc::Status::OK;
  }});
  const Outcome outcome = Run("drag", {"--rate", "10000"});
  ExpectRefused(outcome);
  EXPECT_THAT(outcome.err, HasSubstr("ended the stream early"));
}

TEST_F(Hostile, OneThatOnlyPongsIsLeft) {
  Serve({.stream = [](HostileServer::Stream& stream) {
    for (v1::StreamDeformRequest request; stream.Read(&request);) {
      if (!request.has_ping()) continue;
      v1::StreamDeformResponse response;
      response.mutable_pong()->set_nonce(request.ping().nonce());
      stream.Write(response);
    }
    return grpc::Status::OK;
  }});
  const Outcome outcome = Run("drag", {"--timeout", "1", "--rate", "1"});
  ExpectRefused(outcome);
  EXPECT_THAT(outcome.err, HasSubstr("DEADLINE_EXCEEDED"));
}

TEST_F(Hostile, OneThatIsSilentIsLeft) {
  const auto silence = [this](auto&&...) { return server().Silence(); };
  Serve({.info = silence, .mesh = {}, .flatten = silence, .track = silence, .stream = silence});
  for (const Outcome& outcome :
       {Run("bake", {"--timeout", "1"}), Run("drag", {"--timeout", "1"}),
        Flatten({"--timeout", "1"}), Flatten({"--timeout", "1", "--compare", Path("c.svg")})}) {
    ExpectRefused(outcome);
    EXPECT_THAT(outcome.err, HasSubstr("DEADLINE_EXCEEDED"));
  }
  Serve({.mesh = silence});
  ExpectRefused(Run("bake", {"--timeout", "1"}));
}

TEST_F(Hostile, LayoutsThatDoNotFitAreRefused) {
  const auto right = [](v1::FlattenResponse& flat) {
    for (const double x : {0, 0, 1, 0, 1, 1, 0, 1}) flat.add_uv64(x);
    for (const std::uint32_t v : {0U, 1U, 2U, 3U}) flat.add_uv_vertex(v);
    for (const std::uint32_t v : {0U, 1U, 2U, 0U, 2U, 3U}) flat.add_corner_uv(v);
    for (int i = 0; i < 4; ++i) flat.add_singular_values(1);
    for (int i = 0; i < 2; ++i) flat.add_triangle_chart(0);
    v1::FlatChart& chart = *flat.add_charts();
    chart.set_triangle_count(2);
    v1::FlatLoop& loop = *chart.add_loops();
    for (const std::uint32_t v : {0U, 1U, 2U, 3U}) loop.add_uv_indices(v);
  };
  const std::vector<std::function<void(v1::FlattenResponse&)>> wrong{
      [](auto& flat) { flat.Clear(); },
      [](auto& flat) { flat.set_uv64(2, NAN); },
      [](auto& flat) { flat.mutable_uv64()->RemoveLast(); },
      [](auto& flat) { flat.mutable_uv64()->Truncate(4); },
      [](auto& flat) { flat.set_uv_vertex(1, 4); },
      [](auto& flat) { flat.set_uv_vertex(1, 0); },
      [](auto& flat) { flat.set_corner_uv(5, 4); },
      [](auto& flat) { flat.mutable_corner_uv()->Truncate(3); },
      [](auto& flat) { flat.clear_singular_values(); },
      [](auto& flat) { flat.set_triangle_chart(1, 7); },
      [](auto& flat) {
        for (const std::uint32_t v : {9U, 0U}) flat.add_cut_edges(v);
      },
      [](auto& flat) { flat.add_left_out_triangles(2); },
      [](auto& flat) { flat.mutable_charts(0)->mutable_loops(0)->set_uv_indices(0, 99); },
      [](auto& flat) { flat.mutable_charts(0)->add_anchors(4); },
      [](auto& flat) { flat.clear_charts(); },
  };
  for (std::size_t i = 0; i < wrong.size(); ++i) {
    SCOPED_TRACE(i);
    Serve({.flatten = [&](const auto&, v1::FlattenResponse& flat) {
      right(flat);
      wrong[i](flat);
      return grpc::Status::OK;
    }});
    ExpectRefused(Flatten());
  }
  Serve({.flatten = [&](const auto&, v1::FlattenResponse& flat) {
    right(flat);
    return grpc::Status::OK;
  }});
  const Outcome outcome = Flatten();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
}

// A terminal does what it is told; what a server says must not be what tells it.
TEST_F(Hostile, WhatItSaysIsPrintedWithoutEffect) {
  const auto failing = [](auto&&...) {
    return grpc::Status(grpc::StatusCode::INVALID_ARGUMENT, kEscapes);
  };
  Serve({.info = failing, .mesh = {}, .flatten = failing, .track = failing, .stream = failing});
  for (const Outcome& outcome : {Run("info"), Run("bake"), Run("drag"), Flatten()}) {
    ExpectRefused(outcome);
    EXPECT_THAT(outcome.err, HasSubstr("\\x1b]0;owned\\x07\\x1b[2J"));
  }
  Serve({.info =
             [](v1::GetServerInfoResponse& info) {
               info.set_version("1.0\x1b[31m");
               info.add_capabilities("\xe2\x80\xaetrap\x07");
               return grpc::Status::OK;
             },
         .mesh =
             [](v1::RegisterMeshResponse& response) {
               for (int i = 0; i < 1000; ++i) {
                 v1::Warning& warning = *response.mutable_mesh()->add_warnings();
                 warning.set_kind("k\x1b");
                 warning.set_message("m\x1b[2J");
               }
               return grpc::Status::OK;
             }});
  for (const Outcome& outcome : {Run("info"), Run("info", {"--json"}), Run("bake")}) {
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    ExpectClean(outcome);
    EXPECT_LT(outcome.err.size(), 10'000u);
  }
}

}  // namespace
}  // namespace arap::cli
