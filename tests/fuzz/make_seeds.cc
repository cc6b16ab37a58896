// Writes the first inputs of every target: what a well-behaved client would say. The corpus in the
// repository began with them.
//
// Usage: fuzz_seeds FOLDER
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include <arap/v1/flattening_service.pb.h>
#include <arap/v1/server_service.pb.h>

#include "tests/fuzz/seeds.h"
#include "tests/fuzz/targets.h"
#include "tests/fuzz/world.h"

namespace arap::fuzz {
namespace {

std::string Part(const google::protobuf::Message& message) {
  const std::string bytes = message.SerializeAsString();
  return std::string{static_cast<char>(bytes.size() & 0xFFu),
                     static_cast<char>(bytes.size() >> 8u)} +
         bytes;
}

// Method `choice` of a family, with names filled in.
std::string Call(int choice, const google::protobuf::Message& message) {
  return static_cast<char>(0x80 | choice) + Part(message);
}

v1::DeformRequest DeformRequestOf(bool everything) {
  v1::DeformRequest request;
  double x = 0.5;
  for (const char* id : {"a", "b", "c"}) {
    v1::HandleTarget& target = *request.add_targets();
    target.set_handle_id(id);
    target.set_x(x);
    target.set_y(1);
    x += 1;
    if (everything) {
      target.set_angle_radians(0.5);
      target.set_scale(1.5);
    }
  }
  if (everything) {
    request.mutable_options()->set_mode(v1::DEFORM_MODE_SIMILARITY);
    request.mutable_options()->set_refine(2);
    request.mutable_options()->set_float64(true);
    request.mutable_options()->set_include_flipped_ids(true);
    for (const double number : {1.0, 1.0, 2.5, 0.5}) request.add_pick_points(number);
  }
  return request;
}

v1::Handle NewHandle() {
  v1::Handle handle;
  handle.set_handle_id("d");
  handle.mutable_triangle_point()->set_triangle(7);
  for (const double weight : {0.25, 0.25, 0.5}) {
    handle.mutable_triangle_point()->add_barycentric(weight);
  }
  handle.set_weight(100);
  handle.set_area_radius(0.75);
  handle.set_depth(2);
  handle.set_depth_falloff(1);
  return handle;
}

v1::EditHandlesRequest EditRequest() {
  v1::EditHandlesRequest request;
  request.add_remove("a");
  *request.add_add() = NewHandle();
  return request;
}

// An open bumpy sheet, or a closed surface.
v1::FlattenRequest FlattenRequestOf(bool closed) {
  v1::FlattenRequest request;
  v1::SurfaceMesh& mesh = *request.mutable_mesh();
  if (closed) {
    for (const double number : {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}) mesh.add_vertices(number);
    for (const int vertex : {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3}) {
      mesh.add_triangles(static_cast<std::uint32_t>(vertex));
    }
    return request;
  }
  const v1::PlanarMesh planar = MeshRequest().mesh();
  for (int v = 0; v < planar.vertices_size() / 2; ++v) {
    const double x = planar.vertices(2 * v), y = planar.vertices(2 * v + 1);
    for (const double number : {x, y, 0.2 * x * y}) mesh.add_vertices(number);
  }
  mesh.mutable_triangles()->CopyFrom(planar.triangles());
  return request;
}

void PutSessions(const Seeds& seeds) {
  v1::CreateSessionRequest create;
  create.set_session_id("t");
  create.mutable_ttl()->set_seconds(60);
  (*create.mutable_labels())["who"] = "me";
  v1::ListSessionsRequest list;
  list.set_page_size(1);
  list.set_page_token("a");
  v1::GetSessionRequest get;
  get.set_session_id("t");
  v1::DeleteSessionRequest remove;
  remove.set_session_id("t");
  const std::string as_sent(1, '\0');
  seeds.Put("session", "life",
            as_sent + Part(create) + '\1' + Part(get) + '\2' + Part(list) + '\3' + Part(remove) +
                '\1' + Part(get));
  seeds.Put("session", "delete", Call(3, v1::DeleteSessionRequest()) + Call(1, get));
}

void PutDeformation(const Seeds& seeds) {
  v1::RegisterMeshRequest mesh = MeshRequest();
  mesh.set_mesh_id("n");
  v1::CompileHandlesRequest set = SetRequest();
  set.set_handle_set_id("i");
  seeds.Put("mesh", "register",
            Call(0, mesh) + Call(1, v1::GetMeshRequest()) + Call(3, set) +
                Call(4, DeformRequestOf(false)) + Call(2, v1::DeleteMeshRequest()));
  for (int basis = 1; basis <= 4; ++basis) {
    mesh.mutable_energy()->set_basis(static_cast<v1::Basis>(basis));
    mesh.mutable_energy()->set_weights(v1::EDGE_WEIGHTS_COTANGENT);
    mesh.mutable_energy()->clear_rigidity();
    for (int i = 0; i < 18; ++i) mesh.mutable_energy()->add_rigidity(1 + i % 3);
    seeds.Put("mesh", "basis_" + std::to_string(basis), Call(0, mesh));
  }
  *set.add_handles() = NewHandle();
  seeds.Put("handles", "compile", Call(0, set) + Call(2, v1::GetHandleSetRequest()));
  seeds.Put("handles", "edit",
            Call(1, EditRequest()) + Call(2, v1::GetHandleSetRequest()) +
                Call(4, DeformRequestOf(false)) + Call(3, v1::DeleteHandleSetRequest()));
  v1::CompileHandlesRequest deep = SetRequest();
  deep.set_handle_set_id("i");
  deep.mutable_handles(0)->set_depth(1e300);
  deep.mutable_handles(2)->set_depth(-1e300);
  seeds.Put("handles", "depth_beyond_float", Call(0, deep) + Call(2, v1::GetHandleSetRequest()));
  seeds.Put("deform", "plain", Call(0, DeformRequestOf(false)));
  seeds.Put("deform", "everything", Call(0, DeformRequestOf(true)));
  v1::DeformRequest some = DeformRequestOf(false);
  some.mutable_options()->set_encoding(v1::POSITION_ENCODING_INT16_LE);
  for (const std::uint32_t vertex : {7u, 2u, 11u})
    some.mutable_options()->add_vertex_subset(vertex);
  seeds.Put("deform", "some_as_integers", Call(0, some));
  some.mutable_options()->set_encoding(v1::POSITION_ENCODING_FLOAT32_LE);
  some.mutable_options()->set_relative_to_origin(true);
  some.mutable_options()->clear_vertex_subset();
  some.mutable_options()->set_boundary_only(true);
  some.mutable_targets(0)->set_x(1e39);
  seeds.Put("deform", "boundary_as_bytes", Call(0, some));

  v1::DeformTrackRequest track;
  for (const char* id : {"c", "a", "b"}) track.add_handle_ids(id);
  for (int frame = 0; frame < 3; ++frame) {
    v1::TrackFrame& one = *track.add_frames();
    for (const double number : {1.25, 2.5, 0.0, 0.0, 3.0, 0.5}) one.add_positions(number + frame);
    for (int i = 0; i < 3; ++i) one.add_angles_radians(0.1 * frame);
    for (int i = 0; i < 3; ++i) one.add_scales(1 + 0.1 * frame);
  }
  seeds.Put("track", "three", track.SerializeAsString());
  *track.mutable_options() = some.options();
  seeds.Put("track", "boundary_as_bytes", track.SerializeAsString());
  track.mutable_options()->set_boundary_only(false);
  track.mutable_options()->set_encoding(v1::POSITION_ENCODING_INT16_LE);
  track.mutable_options()->add_vertex_subset(3);
  seeds.Put("track", "one_as_integers", track.SerializeAsString());
}

void PutOutlines(const Seeds& seeds) {
  using Points = std::vector<double>;
  const auto square = [](double x, double y, double side) {
    return Points{x, y, x + side, y, x + side, y + side, x, y + side};
  };
  const auto put = [&](const char* name, std::uint32_t vertices,
                       const std::vector<Points>& outlines, double tolerance = 0,
                       double expansion = 0) {
    v1::MeshOutlineRequest request;
    for (const Points& points : outlines) {
      request.add_outlines()->mutable_points()->Assign(points.begin(), points.end());
    }
    request.set_vertex_count(vertices);
    request.set_tolerance(tolerance);
    request.set_expansion(expansion);
    seeds.Put("mesh", std::string("outline_") + name, Call(5, request));
  };
  put("plain", 20, {square(0, 0, 8)});
  put("island_in_a_hole", 60, {square(0, 0, 8), square(2, 2, 4), square(3, 3, 2)});
  put("pieces", 1, {square(0, 0, 2), square(5, 0, 2), {-3, 0, -1, 0, -2, 0.001}});
  put("touching", 20, {square(0, 0, 2), square(2, 2, 2)});
  put("crossing", 20, {{0, 0, 4, 4, 4, 0, 0, 4}});
  put("far", 20, {square(1e15, -1e15, -1)});
  put("simplified", 20, {{0, 0, 4, 0.01, 8, 0, 8, 8, 0, 8}}, 0.1);
  put("grown", 30, {square(0, 0, 8), square(2, 2, 4), square(9, 0, 2)}, 0.1, 0.75);
  put("grown_to_touch", 30, {square(0, 0, 2), square(4, 0, 2)}, 0, 1);
}

void PutStreams(const Seeds& seeds) {
  v1::StreamDeformRequest open, update, packed, edit, ping;
  open.mutable_open()->set_session_id(kSession);
  open.mutable_open()->set_handle_set_id(kSet);
  open.mutable_open()->mutable_options()->set_refine(1);
  update.mutable_update()->set_sequence(1);
  update.mutable_update()->mutable_targets()->CopyFrom(DeformRequestOf(true).targets());
  packed.mutable_update()->set_sequence(2);
  for (const double number : {0.0, 0.0, 4.0, 0.0, 1.0, 3.0}) {
    packed.mutable_update()->add_positions(number);
  }
  packed.mutable_update()->add_pick_points(1);
  packed.mutable_update()->add_pick_points(2);
  edit.mutable_edit()->set_sequence(3);
  edit.mutable_edit()->add_remove("b");
  *edit.mutable_edit()->add_add() = NewHandle();
  ping.mutable_ping()->set_nonce(7);
  const std::string talk = Part(update) + Part(ping) + Part(packed) + Part(edit) + Part(update);
  seeds.Put("stream", "latest", '\1' + talk);
  seeds.Put("stream", "every", '\3' + talk);
  seeds.Put("stream", "own_open", std::string(1, '\0') + Part(open) + talk);
  // The bits that stream_targets.cc makes options of.
  seeds.Put("stream", "boundary_as_integers", '\xb1' + talk);
  seeds.Put("stream", "relative_bytes", '\x63' + talk);
  open.mutable_open()->mutable_options()->add_vertex_subset(5);
  open.mutable_open()->mutable_options()->add_vertex_subset(1);
  open.mutable_open()->mutable_options()->set_relative_to_origin(true);
  seeds.Put("stream", "own_subset", std::string(1, '\0') + Part(open) + talk);
}

void PutFlattening(const Seeds& seeds) {
  seeds.Put("flatten", "plain", Call(0, FlattenRequestOf(false)));
  v1::FlattenRequest closed = FlattenRequestOf(true);
  closed.set_auto_cut(true);
  closed.set_surface_key("k");
  seeds.Put("flatten", "closed", Call(0, closed) + Call(0, closed));
  for (int method = 1; method <= 5; ++method) {
    v1::FlattenRequest request = FlattenRequestOf(false);
    request.set_method(static_cast<v1::FlattenMethod>(method));
    request.set_anchors(static_cast<v1::FlattenAnchors>(1 + method % 3));
    request.set_refine(4);
    request.set_refine_stop(1e-3);
    request.set_include_first_step(true);
    request.set_include_singular_values(true);
    request.set_float64(method % 2 == 0);
    request.set_injective(method == 1);
    request.set_split_non_manifold(true);
    request.set_tolerate_degenerate(true);
    for (const std::uint32_t vertex : {5u, 6u, 6u, 10u}) request.add_seam_edges(vertex);
    v1::UvPin& pin = *request.add_pins();
    pin.set_vertex(0);
    pin.set_u(1);
    pin.set_weight(2);
    v1::GrainLine& grain = *request.add_grain_lines();
    grain.set_from_vertex(0);
    grain.set_to_vertex(3);
    grain.set_angle_degrees(30);
    seeds.Put("flatten", "method_" + std::to_string(method), Call(0, request));
  }
}

void PutDrawings(const Seeds& seeds) {
  for (int format = 1; format <= 3; ++format) {
    v1::FlattenRequest request = FlattenRequestOf(false);
    for (const std::uint32_t vertex : {4u, 5u, 5u, 6u, 6u, 7u}) request.add_seam_edges(vertex);
    v1::DrawingOptions& drawing = *request.add_drawings();
    drawing.set_format(static_cast<v1::DrawingFormat>(format));
    drawing.set_millimetres_per_unit(10);
    drawing.set_allowance(3);
    drawing.set_corners(static_cast<v1::AllowanceCorners>(format));
    drawing.set_notches(true);
    drawing.set_sheet_width(50);
    drawing.set_interior(format == 1);
    v1::NamedPart& part = *request.add_parts();
    part.set_first_triangle(3);
    part.set_name("\xc3\xa4 & <b>");
    seeds.Put("flatten", "drawing_" + std::to_string(format), Call(0, request));
    if (format == 2) continue;
    drawing.clear_interior();
    drawing.set_paper("100x120");
    drawing.set_overlap(20);
    drawing.set_margin(5);
    seeds.Put("flatten", "pages_" + std::to_string(format), Call(0, request));
  }
}

// Methods as request_targets.cc has them.
void PutJobs(const Seeds& seeds) {
  v1::SubmitFlattenRequest submit;
  *submit.mutable_flatten() = FlattenRequestOf(false);
  const std::string begin = Call(1, submit);
  v1::GetResultRequest result;
  v1::CancelJobRequest cancel;
  v1::WatchJobRequest watch;
  v1::DownloadResultRequest download;
  seeds.Put("flatten", "job", begin + Call(4, watch) + Call(2, result) + Call(5, download));
  seeds.Put("flatten", "job_cancelled",
            begin + Call(3, cancel) + Call(4, watch) + Call(2, result) + begin);
  seeds.Put("flatten", "job_early", Call(4, watch) + begin + Call(2, result) + Call(5, download));
  result.set_max_response_bytes(10);
  download.set_offset(7);
  seeds.Put("flatten", "job_pieces",
            begin + begin + Call(4, watch) + Call(2, result) + Call(5, download));
  // A closed surface without a cut fails.
  *submit.mutable_flatten() = FlattenRequestOf(true);
  seeds.Put("flatten", "job_failed", Call(1, submit) + Call(4, watch) + Call(2, result) + begin);
}

// Events as policy_driver.cc reads them: the first two bytes choose the delivery and open.
void PutPolicy(const Seeds& seeds) {
  const std::string update("\x0b\x07\x01\x01\x70\x80\x00", 7);  // one handle moves
  const std::string bad("\x0b\x07\x01\x04\x70\x80\x00", 7);     // one that is not there
  const std::string packed("\x0b\x06\x06\x60\x60\xa0\x60\x60\xa0", 9);
  const std::string edit("\x0b\x05\x01\x00", 4);
  const std::string ping("\x0b\x03\x07", 3);
  const std::string job("\x06", 1);        // ends
  const std::string write("\x08\x00", 2);  // likewise
  const std::string later("\x02\x64", 2);
  const std::string talk = write + update + update + ping + write + update + job + write + bad +
                           job + write + write + edit + job + write + packed + later + packed +
                           job + write + update + later + later + later + update + job + write;
  for (int every = 0; every < 2; ++every) {
    const std::string name = every != 0 ? "every" : "latest";
    const std::string head{static_cast<char>(every), '\1'};
    seeds.Put("policy", name, head + talk);
    seeds.Put("policy", name + "_full", head + std::string("\x00\x01", 2) + talk);
    seeds.Put("policy", name + "_half_close", head + update + update + std::string("\x0a\xff", 2));
    seeds.Put("policy", name + "_end",
              head + update + update + std::string("\x03\xff\x00", 3) + talk);
    seeds.Put("policy", name + "_cancel", head + talk + std::string("\x03\xff\x01", 3));
  }
  seeds.Put("policy", "no_open", std::string("\0\0", 2) + update + talk);
}

// These have a format of their own: bytes that lead into every branch.
void PutCore(const Seeds& seeds) {
  for (int i = 0; i < 12; ++i) {
    std::string bytes;
    for (int k = 0; k < 200; ++k) {
      bytes.push_back(static_cast<char>((k * (2 * i + 1) * 37 + i * 11) % 0xC0));
    }
    bytes[0] = static_cast<char>(i % 3);
    seeds.Put("core_deform", std::to_string(i), bytes);
    seeds.Put("core_flatten", std::to_string(i), bytes);
  }
}

}  // namespace
}  // namespace arap::fuzz

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: fuzz_seeds FOLDER\n");
    return 2;
  }
  const arap::fuzz::Seeds seeds(argv[1]);
  arap::fuzz::PutSessions(seeds);
  arap::fuzz::PutDeformation(seeds);
  arap::fuzz::PutOutlines(seeds);
  arap::fuzz::PutStreams(seeds);
  arap::fuzz::PutFlattening(seeds);
  arap::fuzz::PutDrawings(seeds);
  arap::fuzz::PutJobs(seeds);
  arap::fuzz::PutCore(seeds);
  arap::fuzz::PutPolicy(seeds);
  arap::fuzz::PutTexts(seeds);
  arap::fuzz::PutFiles(seeds);
  seeds.Put("server", "info", arap::fuzz::Call(0, arap::v1::GetServerInfoRequest()));
}
