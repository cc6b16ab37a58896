#include <math.h>
#include <string.h>

#include "tests/client/c_calls.h"
#include "tests/client/c_must.h"

static int Near(double a, double b) { return fabs(a - b) < 1e-6; }

/* Of the points (0.25, 0.75) and (9, 9) of the shape at rest, moved by (x, y). */
static const char* CheckPicks(const arap_shape* shape) {
  MUST(arap_shape_pick_count(shape) == 2);
  const arap_pick pick = arap_shape_pick(shape, 0);
  MUST(pick.hit == 1 && pick.triangle == 1);
  MUST(Near(pick.barycentric[0], 0.25) && Near(pick.barycentric[1], 0.25));
  MUST(Near(pick.barycentric[2], 0.5));
  MUST(Near(pick.x, 0.25) && Near(pick.y, 0.75));
  MUST(arap_shape_pick(shape, 1).hit == 0 && arap_shape_pick(shape, 2).hit == 0);
  return NULL;
}

const char* CPicks(const char* address) {
  arap_client* client = NULL;
  arap_session* session = NULL;
  const char* wrong = CPrepare(address, &client, &session);
  if (wrong != NULL) return wrong;
  const arap_target targets[] = {
      {"left", 10, 20, 0, 1}, {"right", 12, 20.5, 0, 1}, {"middle", 10.5, 20.5, 0, 1}};
  const double moved[] = {10.25, 20.75, 19, 29};
  arap_shape_options options = ARAP_OPTIONS(arap_shape_options);
  options.float64 = 1;
  arap_shape* shape = NULL;
  WELL(arap_deform_and_pick(session, "set", targets, 3, moved, 2, &options, NULL, &shape));
  wrong = CheckPicks(shape);
  if (wrong != NULL) return wrong;
  arap_shape_free(shape);
  WELL(arap_deform(session, "set", targets, 3, NULL, NULL, &shape));
  MUST(arap_shape_pick_count(shape) == 0 && arap_shape_pick(shape, 0).hit == 0);
  arap_shape_free(shape);
  shape = NULL;
  REFUSED(arap_deform_and_pick(session, "set", targets, 3, NULL, 1, NULL, NULL, &shape),
          "INVALID_OPTION", "points");
  static double many[2 * 1025];
  REFUSED(arap_deform_and_pick(session, "set", targets, 3, many, 1025, NULL, NULL, &shape),
          "ARRAY_LENGTH", "pick_points");
  MUST(shape == NULL);

  /* In a stream, of no handle and then of one. */
  arap_stream_options streaming = ARAP_OPTIONS(arap_stream_options);
  streaming.every = 1;
  streaming.shape = &options;
  arap_stream* stream = NULL;
  WELL(arap_open_stream(session, "set", &streaming, NULL, &stream));
  const double rest[] = {0.25, 0.75, 9, 9};
  const arap_target same = {"middle", 0.5, 0.5, 0, 1};
  for (uint64_t sequence = 1; sequence <= 2; ++sequence) {
    WELL(arap_stream_move_and_pick(stream, sequence, &same, sequence - 1, rest, 2));
    arap_event* event = NULL;
    WELL(arap_stream_take(stream, &event));
    MUST(arap_event_kind(event) == ARAP_EVENT_SHAPE && arap_event_sequence(event) == sequence);
    wrong = CheckPicks(arap_event_shape(event));
    if (wrong != NULL) return wrong;
    arap_event_free(event);
  }
  REFUSED(arap_stream_move_and_pick(stream, 3, NULL, 0, NULL, 1), "INVALID_OPTION", "points");
  arap_stream_free(stream);
  WELL(arap_delete_session(session, NULL));
  arap_session_free(session);
  arap_client_free(client);
  return NULL;
}

typedef struct Frames {
  const double* corner; /* where the last vertex is in each frame */
  size_t count;
  size_t stop_after;
  int right;
} Frames;

static int32_t TakeFrame(void* user, const arap_shape* shape) {
  Frames* frames = (Frames*)user;
  const double* last = arap_shape_positions(shape) + 2 * (kVertices - 1);
  const double* corner = frames->corner + 2 * frames->count;
  if (arap_shape_sequence(shape) != frames->count || arap_shape_vertex_count(shape) != kVertices ||
      !Near(last[0], corner[0]) || !Near(last[1], corner[1])) {
    frames->right = 0;
  }
  return ++frames->count < frames->stop_after;
}

const char* CTracks(const char* address) {
  arap_client* client = NULL;
  arap_session* session = NULL;
  const char* wrong = CPrepare(address, &client, &session);
  if (wrong != NULL) return wrong;
  arap_shape_options options = ARAP_OPTIONS(arap_shape_options);
  options.float64 = 1;

  /* Not in the order of the set. */
  const char* ids[] = {"right", "left", "middle"};
  const double positions[] = {2, 0.5, 0, 0, 0.5, 0.5, 12, 20.5, 10, 20, 10.5, 20.5};
  const double corners[] = {2, 1, 12, 21};
  Frames frames = {corners, 0, 9, 1};
  WELL(arap_deform_track(session, "set", ids, 3, positions, NULL, 2, &options, TakeFrame, &frames,
                         NULL));
  MUST(frames.count == 2 && frames.right);
  frames = (Frames){corners, 0, 1, 1};
  REFUSED(arap_deform_track(session, "set", ids, 3, positions, NULL, 2, &options, TakeFrame,
                            &frames, NULL),
          "CANCELLED", "");
  MUST(frames.count == 1 && frames.right);
  WELL(
      arap_deform_track(session, "set", ids, 3, NULL, NULL, 0, &options, TakeFrame, &frames, NULL));

  /* A handle that turns takes everything with it. */
  const arap_handle hinge = {
      .id = "hinge", .where = ARAP_AT_VERTEX, .index = 1, .hard = 1, .oriented = 1};
  WELL(arap_compile_handles(session, "hinged", "mesh", &hinge, 1, NULL, NULL));
  const char* hinge_id[] = {"hinge"};
  const double still[] = {1, 0, 1, 0};
  const double turns[] = {0, 1, acos(0), 1};
  const double turned[] = {2, 1, 0, 1};
  frames = (Frames){turned, 0, 9, 1};
  WELL(arap_deform_track(session, "hinged", hinge_id, 1, still, turns, 2, &options, TakeFrame,
                         &frames, NULL));
  MUST(frames.count == 2 && frames.right);

  REFUSED(arap_deform_track(session, "set", ids, 3, positions, NULL, 2, NULL, NULL, NULL, NULL),
          "INVALID_OPTION", "on_frame");
  REFUSED(arap_deform_track(session, "set", ids, 3, NULL, NULL, 2, NULL, TakeFrame, &frames, NULL),
          "INVALID_OPTION", "positions");
  REFUSED(arap_deform_track(session, "set", ids, 3, positions, NULL, SIZE_MAX / 2, NULL, TakeFrame,
                            &frames, NULL),
          "INVALID_OPTION", "positions");
  REFUSED(arap_deform_track(session, "set", NULL, 3, positions, NULL, 2, NULL, TakeFrame, &frames,
                            NULL),
          "INVALID_OPTION", "handle_ids");
  REFUSED(
      arap_deform_track(NULL, "set", ids, 3, positions, NULL, 2, NULL, TakeFrame, &frames, NULL),
      "INVALID_OPTION", "session");
  REFUSED(
      arap_deform_track(session, "set", ids, 2, positions, NULL, 2, NULL, TakeFrame, &frames, NULL),
      "TARGET_COUNT", "handle_ids");
  const double nowhere[] = {2, 0.5, 0, 0, 0.5, 0.5, 12, 20.5, 10, NAN, 10.5, 20.5};
  frames = (Frames){corners, 0, 9, 1};
  REFUSED(
      arap_deform_track(session, "set", ids, 3, nowhere, NULL, 2, NULL, TakeFrame, &frames, NULL),
      "NON_FINITE_TARGET", "frames[1]");
  WELL(arap_delete_session(session, NULL));
  arap_session_free(session);
  arap_client_free(client);
  return NULL;
}

const char* COutlines(const char* address) {
  arap_client* client = NULL;
  arap_session* session = NULL;
  WELL(arap_connect(address, NULL, &client));
  /* A frame: a square with a square hole. */
  const double points[] = {0, 0, 4, 0, 4, 4, 0, 4, 1, 1, 3, 1, 3, 3, 1, 3};
  const size_t lengths[] = {4, 4};
  arap_outline_mesh* made = NULL;
  arap_outline_options options = ARAP_OPTIONS(arap_outline_options);
  options.vertices = 100;
  WELL(arap_mesh_outline(client, points, lengths, 2, &options, NULL, &made));
  const size_t vertices = arap_outline_mesh_vertex_count(made);
  const size_t triangles = arap_outline_mesh_triangle_count(made);
  MUST(vertices > 50 && vertices < 200 && triangles > 50);
  MUST(arap_outline_mesh_piece_count(made) == 1 && arap_outline_mesh_hole_count(made) == 1);
  MUST(arap_outline_mesh_smallest_angle(made) > 20);
  WELL(arap_create_session(client, NULL, 0, NULL, &session));
  arap_mesh* mesh = NULL;
  WELL(arap_register_mesh(session, NULL, arap_outline_mesh_vertices(made), vertices,
                          arap_outline_mesh_triangles(made), triangles, NULL, NULL, &mesh));
  MUST(Near(arap_mesh_area(mesh), 12));
  MUST(arap_outline_mesh_outline_error(made) == 0);
  arap_mesh_free(mesh);
  arap_outline_mesh_free(made);
  made = NULL;
  /* The hole closes when all of it is as near as that. */
  options.expansion = 1.5;
  options.tolerance = 0.1;
  WELL(arap_mesh_outline(client, points, lengths, 2, &options, NULL, &made));
  MUST(arap_outline_mesh_piece_count(made) == 1 && arap_outline_mesh_hole_count(made) == 0);
  MUST(arap_outline_mesh_outline_error(made) > 0 && arap_outline_mesh_outline_error(made) < 0.2);
  arap_outline_mesh_free(made);
  made = NULL;

  const size_t two[] = {2};
  REFUSED(arap_mesh_outline(client, points, two, 1, NULL, NULL, &made), "INVALID_OPTION",
          "outlines");
  options.expansion = -1;
  REFUSED(arap_mesh_outline(client, points, lengths, 2, &options, NULL, &made), "INVALID_OPTION",
          "expansion");
  options.size = 0;
  REFUSED(arap_mesh_outline(client, points, lengths, 2, &options, NULL, &made), "INVALID_OPTION",
          "options.size");
  REFUSED(arap_mesh_outline(client, NULL, lengths, 2, NULL, NULL, &made), "INVALID_OPTION",
          "points");
  REFUSED(arap_mesh_outline(client, points, NULL, 2, NULL, NULL, &made), "INVALID_OPTION",
          "lengths");
  const size_t endless[] = {4, SIZE_MAX - 3};
  REFUSED(arap_mesh_outline(client, points, endless, 2, NULL, NULL, &made), "INVALID_OPTION",
          "lengths");
  REFUSED(arap_mesh_outline(NULL, points, lengths, 2, NULL, NULL, &made), "INVALID_OPTION",
          "client");
  REFUSED(arap_mesh_outline(client, points, lengths, 2, NULL, NULL, NULL), "INVALID_OPTION", "out");
  MUST(made == NULL);
  WELL(arap_delete_session(session, NULL));
  arap_session_free(session);
  arap_client_free(client);
  arap_outline_mesh_free(NULL);
  return NULL;
}
