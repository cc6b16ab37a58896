#include <math.h>
#include <string.h>

#include "tests/client/c_calls.h"
#include "tests/client/c_must.h"

const char* CRefusals(const char* address) {
  arap_client* client = NULL;
  arap_session* session = NULL;
  const char* wrong = CPrepare(address, &client, &session);
  if (wrong != NULL) return wrong;

  /* What the server says of elements, details, codes. */
  const uint32_t beyond[] = {0, 1, 4, 0, 4, 6};
  arap_error* error =
      arap_register_mesh(session, NULL, kPlane, kVertices, beyond, 2, NULL, NULL, NULL);
  MUST(error != NULL);
  MUST(strcmp(arap_error_reason(error), "INDEX_OUT_OF_RANGE") == 0);
  MUST(arap_error_code(error) == 3 && arap_error_retry_ms(error) == 0);
  MUST(arap_error_element_count(error) == 1 && arap_error_elements(error)[0] == 1);
  MUST(strcmp(arap_error_detail(error, "grpc_code"), "INVALID_ARGUMENT") == 0);
  MUST(arap_error_detail(error, "no such detail") == NULL);
  const size_t details = arap_error_detail_count(error);
  MUST(details > 0 && arap_error_detail_name(error, details - 1) != NULL);
  MUST(arap_error_detail_value(error, details - 1) != NULL);
  MUST(arap_error_detail_name(error, details) == NULL);
  MUST(arap_error_detail_value(error, details) == NULL);
  arap_error_free(error);
  REFUSED(arap_register_mesh(session, NULL, NULL, 0, NULL, 0, NULL, NULL, NULL), "EMPTY_MESH",
          "mesh.vertices");

  const arap_handle outside = {.id = "far", .where = ARAP_AT_POINT, .at = {9, 9}};
  REFUSED(arap_compile_handles(session, "other", "mesh", &outside, 1, NULL, NULL), "HANDLE_OUTSIDE",
          "handles[0].position");
  const arap_handle twice[] = {kHandles[0], kHandles[0]};
  REFUSED(arap_compile_handles(session, "other", "mesh", twice, 2, NULL, NULL), "DUPLICATE_HANDLE",
          "handles[1].handle_id");
  REFUSED(arap_compile_handles(session, "other", "no-mesh", kHandles, 3, NULL, NULL), "NOT_FOUND",
          "");
  arap_shape* shape = NULL;
  const arap_target unknown[] = {{"left", 0, 0, 0, 1}, {"right", 0, 0, 0, 1}, {"who", 0, 0, 0, 1}};
  REFUSED(arap_deform(session, "set", unknown, 3, NULL, NULL, &shape), "UNKNOWN_HANDLE",
          "targets[2].handle_id");
  REFUSED(arap_deform(session, "set", unknown, 2, NULL, NULL, &shape), "TARGET_COUNT", "targets");
  const arap_target nowhere[] = {
      {"left", NAN, 0, 0, 1}, {"right", 0, 0, 0, 1}, {"middle", 0, 0, 0, 1}};
  REFUSED(arap_deform(session, "set", nowhere, 3, NULL, NULL, &shape), "NON_FINITE_TARGET",
          "targets[0].x");
  MUST(shape == NULL);
  arap_stream* stream = NULL;
  REFUSED(arap_open_stream(session, "no-set", NULL, NULL, &stream), "NOT_FOUND", "");
  MUST(stream == NULL);
  WELL(arap_delete_session(session, NULL));
  REFUSED(arap_compile_handles(session, "set", "mesh", kHandles, 3, NULL, NULL), "NOT_FOUND", "");
  arap_session_free(session);
  arap_client_free(client);
  return NULL;
}

const char* CBadArguments(void) {
  arap_client* client = NULL;
  REFUSED(arap_connect(NULL, NULL, &client), "INVALID_OPTION", "address");
  REFUSED(arap_connect("localhost:1", NULL, NULL), "INVALID_OPTION", "out");
  arap_connect_options connect = {0};
  REFUSED(arap_connect("localhost:1", &connect, &client), "INVALID_OPTION", "options.size");
  connect.size = sizeof connect;
  connect.token = "secret";
  REFUSED(arap_connect("elsewhere:1", &connect, &client), "INVALID_OPTION", "token");
  connect.token = NULL;
  connect.root_certificates = "/nonexistent/authority.pem";
  REFUSED(arap_connect("elsewhere:1", &connect, &client), "INVALID_OPTION", "root_certificates");
  MUST(client == NULL);

  /* Of an older program, and of a newer one with and without what this version does not know. */
  struct {
    arap_call_options known;
    int64_t unknown;
  } newer = {ARAP_OPTIONS(arap_call_options), 0};
  newer.known.size = sizeof newer;
  newer.known.retry_ms = -1;
  newer.known.timeout_ms = 20000;
  WELL(arap_connect("unix:/nonexistent/arapd.sock", NULL, &client));
  arap_session* session = NULL;
  REFUSED(arap_create_session(client, NULL, 0, &newer.known, &session), "DRAINING", "");
  newer.unknown = 1;
  REFUSED(arap_create_session(client, NULL, 0, &newer.known, &session), "INVALID_OPTION", "call");
  newer.known.size = offsetof(arap_call_options, timeout_ms) - 1;
  REFUSED(arap_create_session(client, NULL, 0, &newer.known, &session), "INVALID_OPTION",
          "call.size");
  REFUSED(arap_create_session(client, "no id", 0, NULL, &session), "INVALID_NAME", "id");
  REFUSED(arap_create_session(client, NULL, -1, NULL, &session), "INVALID_OPTION", "ttl_ms");
  REFUSED(arap_create_session(NULL, NULL, 0, NULL, &session), "INVALID_OPTION", "client");
  REFUSED(arap_attach_session(client, NULL, &session), "INVALID_OPTION", "id");
  REFUSED(arap_wait_ready(client, 1), "DEADLINE_EXCEEDED", "");

  WELL(arap_attach_session(client, "s", &session));
  REFUSED(arap_register_mesh(session, NULL, NULL, 6, kTriangles, 4, NULL, NULL, NULL),
          "INVALID_OPTION", "vertices");
  REFUSED(arap_register_mesh(session, NULL, kPlane, 6, NULL, 4, NULL, NULL, NULL), "INVALID_OPTION",
          "triangles");
  REFUSED(arap_register_mesh(session, NULL, kPlane, SIZE_MAX / 4, kTriangles, 4, NULL, NULL, NULL),
          "INVALID_OPTION", "vertices");
  arap_mesh_options mesh = ARAP_OPTIONS(arap_mesh_options);
  mesh.basis = 5;
  REFUSED(arap_register_mesh(session, NULL, kPlane, 6, kTriangles, 4, &mesh, NULL, NULL),
          "INVALID_OPTION", "basis");
  mesh.basis = 0;
  mesh.weights = -1;
  REFUSED(arap_register_mesh(session, NULL, kPlane, 6, kTriangles, 4, &mesh, NULL, NULL),
          "INVALID_OPTION", "weights");
  arap_handle handle = {.id = NULL};
  REFUSED(arap_compile_handles(session, "set", "mesh", &handle, 1, NULL, NULL), "INVALID_OPTION",
          "handles[0].id");
  handle.id = "";
  REFUSED(arap_compile_handles(session, "set", "mesh", &handle, 1, NULL, NULL), "INVALID_NAME",
          "handles[0].id");
  handle.id = "a";
  handle.where = 3;
  REFUSED(arap_compile_handles(session, "set", "mesh", &handle, 1, NULL, NULL), "INVALID_OPTION",
          "handles[0].where");
  arap_shape_options shaping = ARAP_OPTIONS(arap_shape_options);
  arap_shape* shape = NULL;
  shaping.mode = 4;
  REFUSED(arap_deform(session, "set", NULL, 0, &shaping, NULL, &shape), "INVALID_OPTION", "mode");
  shaping.mode = 0;
  shaping.refine = -1;
  REFUSED(arap_deform(session, "set", NULL, 0, &shaping, NULL, &shape), "INVALID_OPTION", "refine");
  shaping.refine = 0;
  shaping.encoding = 4;
  REFUSED(arap_deform(session, "set", NULL, 0, &shaping, NULL, &shape), "INVALID_OPTION",
          "encoding");
  shaping.encoding = 0;
  shaping.vertex_subset_count = 1;
  REFUSED(arap_deform(session, "set", NULL, 0, &shaping, NULL, &shape), "INVALID_OPTION",
          "vertex_subset");
  REFUSED(arap_deform(session, "set", NULL, 1, NULL, NULL, &shape), "INVALID_OPTION", "targets");
  REFUSED(arap_deform(session, "set", NULL, 0, NULL, NULL, NULL), "INVALID_OPTION", "out");
  arap_event* event = NULL;
  REFUSED(arap_stream_take(NULL, &event), "INVALID_OPTION", "stream");
  REFUSED(arap_stream_move(NULL, 1, NULL, 0), "INVALID_OPTION", "stream");
  arap_stream_cancel(NULL);
  arap_session_free(session);
  arap_client_free(client);

  /* There is nothing to free. */
  arap_client_free(NULL);
  arap_session_free(NULL);
  arap_mesh_free(NULL);
  arap_handle_set_free(NULL);
  arap_shape_free(NULL);
  arap_stream_free(NULL);
  arap_event_free(NULL);
  arap_flat_free(NULL);
  arap_error_free(NULL);
  MUST(strlen(arap_version()) >= 5);
  return NULL;
}
