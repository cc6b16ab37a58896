#include "tests/client/c_calls.h"

#include <math.h>
#include <string.h>

#include "tests/client/c_must.h"

static int Near(double a, double b) { return fabs(a - b) < 1e-6; }

const char* CPrepare(const char* address, arap_client** client, arap_session** session) {
  WELL(arap_connect(address, NULL, client));
  WELL(arap_wait_ready(*client, 30000));
  WELL(arap_create_session(*client, NULL, 60000, NULL, session));
  MUST(strlen(arap_session_id(*session)) == 32);
  arap_mesh_options options = ARAP_OPTIONS(arap_mesh_options);
  options.basis = ARAP_BASIS_FACE;
  options.weights = ARAP_WEIGHTS_COTANGENT;
  const double rigidity[] = {1, 2, 1, 2};
  options.rigidity = rigidity;
  arap_mesh* mesh = NULL;
  WELL(arap_register_mesh(*session, "mesh", kPlane, kVertices, kTriangles, kTriangleCount, &options,
                          NULL, &mesh));
  MUST(strcmp(arap_mesh_id(mesh), "mesh") == 0);
  MUST(arap_mesh_vertex_count(mesh) == kVertices);
  MUST(arap_mesh_triangle_count(mesh) == kTriangleCount);
  MUST(arap_mesh_component_count(mesh) == 1);
  MUST(Near(arap_mesh_area(mesh), 2));
  MUST(arap_warning_count(arap_mesh_warnings(mesh)) == 0);
  arap_mesh_free(mesh);
  arap_handle_set* set = NULL;
  WELL(arap_compile_handles(*session, "set", "mesh", kHandles, 3, NULL, &set));
  MUST(arap_handle_set_count(set) == 3);
  MUST(Near(arap_handle_set_rest(set)[2], 2) && Near(arap_handle_set_rest(set)[3], 0.5));
  MUST(strcmp(arap_handle_set_handle_id(set, 2), "middle") == 0);
  MUST(arap_handle_set_handle_id(set, 3) == NULL);
  MUST(arap_warning_count(arap_handle_set_warnings(set)) == 0);
  arap_handle_set_free(set);
  return NULL;
}

/* Everything moved by (10, 20). */
static const char* CheckMoved(const arap_shape* shape) {
  MUST(arap_shape_vertex_count(shape) == kVertices && arap_shape_vertices(shape) == NULL);
  for (int i = 0; i < kVertices; ++i) {
    MUST(Near(arap_shape_positions(shape)[2 * i], kPlane[2 * i] + 10));
    MUST(Near(arap_shape_positions(shape)[2 * i + 1], kPlane[2 * i + 1] + 20));
  }
  const arap_quality quality = arap_shape_quality(shape);
  MUST(quality.flipped == 0 && arap_shape_flipped_count(shape) == 0);
  MUST(Near(quality.max_stretch, 1) && Near(quality.worst_handle_error, 0));
  return NULL;
}

const char* CDrag(const char* address) {
  arap_client* client = NULL;
  arap_session* session = NULL;
  const char* wrong = CPrepare(address, &client, &session);
  if (wrong != NULL) return wrong;

  const arap_target targets[] = {
      {"middle", 10.5, 20.5, 0, 1}, {"left", 10, 20, 0, 1}, {"right", 12, 20.5, 0, 1}};
  arap_shape_options shaping = ARAP_OPTIONS(arap_shape_options);
  shaping.float64 = 1;
  shaping.refine = 3;
  shaping.flipped_ids = 1;
  arap_shape* shape = NULL;
  WELL(arap_deform(session, "set", targets, 3, &shaping, NULL, &shape));
  wrong = CheckMoved(shape);
  if (wrong != NULL) return wrong;
  MUST(arap_shape_is_measured(shape) == 1);
  arap_shape_free(shape);
  shaping.measure_every = -1;
  WELL(arap_deform(session, "set", targets, 3, &shaping, NULL, &shape));
  MUST(arap_shape_is_measured(shape) == 0);
  arap_shape_free(shape);
  shaping.measure_every = 2;

  /* Two of the vertices, in two bytes each. */
  const uint32_t some[] = {5, 0};
  arap_shape_options few = ARAP_OPTIONS(arap_shape_options);
  few.encoding = ARAP_INT16_LE;
  few.vertex_subset = some;
  few.vertex_subset_count = 2;
  WELL(arap_deform(session, "set", targets, 3, &few, NULL, &shape));
  MUST(arap_shape_vertex_count(shape) == 2 && arap_shape_vertices(shape)[0] == 5);
  const double error = arap_shape_position_error(shape);
  MUST(error > 0 && error < 1e-3);
  MUST(fabs(arap_shape_positions(shape)[0] - 12) <= error + 1e-6);
  MUST(fabs(arap_shape_positions(shape)[3] - 20) <= error + 1e-6);
  arap_shape_free(shape);

  arap_stream_options options = ARAP_OPTIONS(arap_stream_options);
  options.every = 1;
  options.shape = &shaping;
  options.heartbeat_ms = -1;
  options.resume_within_ms = 10000;
  arap_stream* stream = NULL;
  WELL(arap_open_stream(session, "set", &options, NULL, &stream));
  /* What a stream was made with may go. */
  arap_client_free(client);
  const double all[] = {10, 20, 12, 20.5, 10.5, 20.5};
  WELL(arap_stream_move(stream, 1, all, 3));
  arap_event* event = NULL;
  WELL(arap_stream_take(stream, &event));
  MUST(arap_event_kind(event) == ARAP_EVENT_SHAPE && arap_event_sequence(event) == 1);
  MUST(arap_event_error(event) == NULL);
  wrong = CheckMoved(arap_event_shape(event));
  if (wrong != NULL) return wrong;
  MUST(arap_shape_sequence(arap_event_shape(event)) == 1);
  MUST(arap_shape_replaced(arap_event_shape(event)) == 0);
  arap_event_free(event);

  /* A bad move is refused, and the stream goes on with where the handles were. */
  WELL(arap_stream_move(stream, 2, all, 2));
  WELL(arap_stream_take(stream, &event));
  MUST(arap_event_kind(event) == ARAP_EVENT_REFUSED && arap_event_sequence(event) == 2);
  MUST(arap_event_shape(event) == NULL);
  MUST(strcmp(arap_error_reason(arap_event_error(event)), "TARGET_COUNT") == 0);
  arap_event_free(event);
  WELL(arap_stream_move_some(stream, 3, targets, 1));
  WELL(arap_stream_take(stream, &event));
  MUST(arap_event_kind(event) == ARAP_EVENT_SHAPE && arap_event_sequence(event) == 3);
  MUST(arap_shape_is_measured(arap_event_shape(event)) == 0);
  MUST(Near(arap_shape_quality(arap_event_shape(event)).worst_handle_error, 0));
  arap_event_free(event);
  WELL(arap_stream_move_some(stream, 4, targets, 1));
  WELL(arap_stream_measure(stream, 5));
  for (int i = 0; i < 2; ++i) {
    WELL(arap_stream_take(stream, &event));
    wrong = CheckMoved(arap_event_shape(event));
    if (wrong != NULL) return wrong;
    MUST(arap_shape_is_measured(arap_event_shape(event)) == 1);
    arap_event_free(event);
  }

  WELL(arap_stream_close_sending(stream));
  for (int i = 0; i < 2; ++i) {
    WELL(arap_stream_take(stream, &event));
    MUST(arap_event_kind(event) == ARAP_EVENT_END && arap_event_sequence(event) == 0);
    arap_event_free(event);
  }
  REFUSED(arap_stream_move(stream, 6, all, 3), "PROTOCOL", "");
  arap_stream_free(stream);
  WELL(arap_delete_session(session, NULL));
  arap_session_free(session);
  return NULL;
}

const char* CEdits(const char* address) {
  arap_client* client = NULL;
  arap_session* session = NULL;
  const char* wrong = CPrepare(address, &client, &session);
  if (wrong != NULL) return wrong;
  arap_stream* stream = NULL;
  WELL(arap_open_stream(session, "set", NULL, NULL, &stream));
  const char* gone[] = {"middle"};
  const arap_handle added = {.id = "top", .where = ARAP_AT_POINT, .at = {1, 1.5}, .snap = 1};
  WELL(arap_stream_edit(stream, 1, gone, 1, &added, 1));
  arap_event* event = NULL;
  WELL(arap_stream_take(stream, &event));
  MUST(arap_event_kind(event) == ARAP_EVENT_SHAPE && arap_event_sequence(event) == 1);
  MUST(arap_shape_revision(arap_event_shape(event)) > 0);
  MUST(strlen(arap_shape_worst_handle(arap_event_shape(event))) > 0);
  arap_event_free(event);
  arap_stream_cancel(stream);
  REFUSED(arap_stream_take(stream, &event), "CANCELLED", "");
  arap_stream_free(stream);

  /* The set of the session is as it was; edited there, it tells what it has repaired. */
  arap_handle_set* set = NULL;
  WELL(arap_edit_handles(session, "set", gone, 1, &added, 1, NULL, &set));
  MUST(arap_handle_set_count(set) == 3 && arap_handle_set_revision(set) > 0);
  MUST(Near(arap_handle_set_rest(set)[4], 1) && Near(arap_handle_set_rest(set)[5], 1));
  const arap_warnings* warnings = arap_handle_set_warnings(set);
  MUST(arap_warning_count(warnings) == 1 && arap_warning_elements(warnings, 0) == 1);
  MUST(strlen(arap_warning_kind(warnings, 0)) > 0 && strlen(arap_warning_message(warnings, 0)) > 0);
  MUST(arap_warning_kind(warnings, 1) == NULL && arap_warning_message(warnings, 1) == NULL);
  MUST(arap_warning_elements(warnings, 1) == 0);
  arap_handle_set_free(set);
  REFUSED(arap_edit_handles(session, "set", gone, 1, NULL, 0, NULL, NULL), "UNKNOWN_HANDLE",
          "remove");

  /* By name, from another connection. */
  arap_client* another = NULL;
  arap_session* same = NULL;
  WELL(arap_connect(address, NULL, &another));
  WELL(arap_attach_session(another, arap_session_id(session), &same));
  WELL(arap_delete_session(same, NULL));
  arap_session_free(same);
  arap_session_free(session);
  arap_client_free(another);
  arap_client_free(client);
  return NULL;
}

const char* CFlatten(const char* address) {
  arap_client* client = NULL;
  WELL(arap_connect(address, NULL, &client));
  arap_flatten_options options = ARAP_OPTIONS(arap_flatten_options);
  options.float64 = 1;
  const arap_pin pins[] = {{0, 5, 7, 0}, {3, 5, 8, 0}};
  options.pins = pins;
  options.pin_count = 2;
  arap_flat* flat = NULL;
  WELL(arap_flatten(client, kBent, kVertices, kTriangles, kTriangleCount, &options, NULL, &flat));
  MUST(arap_flat_count(flat) == kVertices);
  for (size_t i = 0; i < kVertices; ++i) {
    MUST(Near(arap_flat_uv(flat)[2 * i], kPlane[2 * i] + 5));
    MUST(Near(arap_flat_uv(flat)[2 * i + 1], kPlane[2 * i + 1] + 7));
    MUST(arap_flat_source(flat)[i] == i);
  }
  MUST(memcmp(arap_flat_corners(flat), kTriangles, sizeof kTriangles) == 0);
  MUST(arap_flat_charts(flat)[3] == 0);
  MUST(arap_flat_chart_count(flat) == 1 && arap_flat_loop_count(flat, 0) == 1);
  MUST(arap_flat_loop_length(flat, 0, 0) == 6 && arap_flat_loop(flat, 0, 0)[0] < kVertices);
  MUST(arap_flat_loop_count(flat, 1) == 0 && arap_flat_loop_length(flat, 0, 1) == 0);
  MUST(arap_flat_loop(flat, 1, 0) == NULL);
  const arap_distortion distortion = arap_flat_distortion(flat);
  MUST(distortion.flipped == 0 && Near(distortion.area_ratio, 1) &&
       Near(distortion.symmetric_dirichlet, 4));
  MUST(arap_flat_overlaps(flat) == 0);
  MUST(arap_warning_count(arap_flat_warnings(flat)) == 0);
  arap_flat_free(flat);

  /* A cut through the middle, one side of which may then turn: two pieces, eight places. */
  const uint32_t seam[] = {1, 4};
  const arap_grain grain = {0, 1, 0};
  options = (arap_flatten_options)ARAP_OPTIONS(arap_flatten_options);
  options.method = ARAP_FLATTEN_LSCM;
  options.seams = seam;
  options.seam_count = 1;
  options.grains = &grain;
  options.grain_count = 1;
  WELL(arap_flatten(client, kBent, kVertices, kTriangles, kTriangleCount, &options, NULL, &flat));
  MUST(arap_flat_count(flat) == 8 && arap_flat_chart_count(flat) == 2);
  arap_flat_free(flat);

  /* A closed surface is no disk, until it is cut. */
  const double corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const uint32_t closed[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};
  REFUSED(arap_flatten(client, corners, 4, closed, 4, NULL, NULL, &flat), "NOT_A_DISK",
          "mesh.triangles");
  options = (arap_flatten_options)ARAP_OPTIONS(arap_flatten_options);
  options.auto_cut = 1;
  WELL(arap_flatten(client, corners, 4, closed, 4, &options, NULL, &flat));
  MUST(arap_flat_count(flat) > 4);
  arap_flat_free(flat);
  options.method = 9;
  REFUSED(arap_flatten(client, corners, 4, closed, 4, &options, NULL, &flat), "INVALID_OPTION",
          "method");
  arap_client_free(client);
  return NULL;
}
