// arap_c.h: the client library for C, and for whatever calls C (ctypes, cffi, P/Invoke, JNI).
//
//   arap_client* client = NULL;
//   arap_error* error = arap_connect("localhost:50051", NULL, &client);
//   if (error == NULL) error = arap_create_session(client, NULL, 0, NULL, &session);
//   if (error == NULL)
//     error = arap_register_mesh(session, "mesh", xy, 4, triangles, 2, NULL, NULL, NULL);
//   …
//   if (error != NULL) fprintf(stderr, "%s\n", arap_error_message(error));
//   arap_error_free(error);
//
// Errors. What can fail answers an arap_error, or NULL when all went well; then, and only then,
// `*out` is set. Where an `out` may be NULL that is said. Nothing throws, prints or ends the
// process. A pointer that has to be there and is NULL and a number that names no choice are
// INVALID_OPTION with the name of the parameter as the field; an id that is none is INVALID_NAME.
//
// Ownership. What a function gives through `out`, and every arap_error that is answered, belongs
// to the caller, who frees it with the function of its type; all of these take NULL. Whatever an
// accessor answers (strings, arrays, parts) belongs to the object and lives as long as it. Nothing
// that is passed in is kept after the call. A session, a stream or a shape may outlive what it was
// made with.
//
// Threads. arap_client and arap_session may be used by any number of threads at once. Of an
// arap_stream one thread may take while others send, and arap_stream_cancel may be called from any
// thread. Everything else is a value that does not change: any number of threads may read it.
// Freeing is for when nobody uses the object any more. Calls block, until the answer is there or
// their time is over.
//
// Arrays are rows of doubles or indices without gaps: n × 2 is x0 y0 x1 y1 …. #V, #F and #H are
// the numbers of vertices, triangles and handles. All lengths are in the units of the mesh, angles
// in radians, counter-clockwise; indices count from 0. An array of length 0 may be NULL.
//
// Options. A pointer to options may be NULL, and a member that is 0 or NULL is the default. `size`
// is sizeof the struct as the caller knows it (ARAP_OPTIONS sets it): members that a later version
// adds are then the default. Structs without `size` never change.
//
// What calls mean, their limits and costs: arap/client/*.h and docs/protocol.md; it all holds here.
#pragma once

#include <stddef.h>
#include <stdint.h>

// NOLINTBEGIN(readability-identifier-naming, modernize-use-using): this is C.
#ifdef __cplusplus
extern "C" {
#endif

// arap_call_options call = ARAP_OPTIONS(arap_call_options);
#define ARAP_OPTIONS(type) \
  { .size = sizeof(type) }

// The version of this library: "0.1.0".
const char* arap_version(void);

// ---- Errors and warnings ----

typedef struct arap_error arap_error;
// One word for what is wrong, for programs: "NOT_A_DISK"; docs/protocol.md has all of them.
const char* arap_error_reason(const arap_error* error);
// A sentence for people; one from a server may hold anything that UTF-8 can say.
const char* arap_error_message(const arap_error* error);
// The parameter or request field at fault ("handles[3].weight"), or "".
const char* arap_error_field(const arap_error* error);
// The canonical code of gRPC by its number: 3 INVALID_ARGUMENT, 5 NOT_FOUND, 14 UNAVAILABLE, ….
int32_t arap_error_code(const arap_error* error);
// After how many milliseconds trying again may help; 0: the same request fails again.
int64_t arap_error_retry_ms(const arap_error* error);
// The first vertices, triangles or handles at fault.
size_t arap_error_element_count(const arap_error* error);
const uint32_t* arap_error_elements(const arap_error* error);
// The values that the message mentions, by name; NULL where there is none of that name or number.
const char* arap_error_detail(const arap_error* error, const char* name);
size_t arap_error_detail_count(const arap_error* error);
const char* arap_error_detail_name(const arap_error* error, size_t index);
const char* arap_error_detail_value(const arap_error* error, size_t index);
void arap_error_free(arap_error* error);

// Things that were repaired or ignored. Part of an answer.
typedef struct arap_warnings arap_warnings;
size_t arap_warning_count(const arap_warnings* warnings);
// For programs ("reversed_triangles"), for people, how many elements; NULL and 0 past the end.
const char* arap_warning_kind(const arap_warnings* warnings, size_t index);
const char* arap_warning_message(const arap_warnings* warnings, size_t index);
size_t arap_warning_elements(const arap_warnings* warnings, size_t index);

// ---- Connections and sessions ----

typedef struct arap_client arap_client;
typedef struct arap_session arap_session;

typedef struct arap_connect_options {
  size_t size;
  const char* token;           // bearer token, sent with every call
  const char* user;            // for whom the calls are made, where the token is a gateway's
  int32_t tls;                 // 1: TLS; implied by each of the files
  int32_t token_in_plaintext;  // 1: the token may go to other machines without TLS
  // Files in PEM, read when connecting: who vouches for the server; the client's own, with its key.
  const char* root_certificates;
  const char* certificate;
  const char* key;
  const char* server_name;  // what the server's certificate says, unless that is in the address
} arap_connect_options;

typedef struct arap_call_options {
  size_t size;
  // For the whole call; 0: 30 s for look-ups, 10 min for work; below 0: for ever.
  int64_t timeout_ms;
  // How long a lost call is made again where that does no harm; 0: 5 s; below 0: not at all.
  int64_t retry_ms;
} arap_call_options;

// `address` is host:port or unix:PATH. Connects in the background: whether anybody is there is
// told by the first call, or by arap_wait_ready.
arap_error* arap_connect(const char* address, const arap_connect_options* options,
                         arap_client** out);
// Waits until the connection stands, below 0 for ever; else DEADLINE_EXCEEDED.
arap_error* arap_wait_ready(const arap_client* client, int64_t timeout_ms);
void arap_client_free(arap_client* client);

// Makes a session, or finds it when it is there already. `id` NULL: 128 random bits. `ttl_ms`: how
// long it lives without use; 0: as the server says.
arap_error* arap_create_session(const arap_client* client, const char* id, int64_t ttl_ms,
                                const arap_call_options* call, arap_session** out);
// A session that exists already; asks nothing.
arap_error* arap_attach_session(const arap_client* client, const char* id, arap_session** out);
const char* arap_session_id(const arap_session* session);
// Ends the session on the server, with all that is in it.
arap_error* arap_delete_session(const arap_session* session, const arap_call_options* call);
// Forgets the object; the session stays on the server.
void arap_session_free(arap_session* session);

// ---- Meshes ----

typedef struct arap_mesh arap_mesh;
// What a cell of the energy is (arap/model/energy.h), and how much an edge counts.
enum {
  ARAP_BASIS_DEFAULT,
  ARAP_BASIS_EDGE,
  ARAP_BASIS_EDGE_AS_PUBLISHED,
  ARAP_BASIS_FACE,
  ARAP_BASIS_VERTEX
};
enum { ARAP_WEIGHTS_DEFAULT, ARAP_WEIGHTS_UNIFORM, ARAP_WEIGHTS_COTANGENT };

// What is mended first (arap/model/repair.h); members are 1 or 0.
typedef struct arap_repairs {
  int32_t weld, drop_duplicates, stitch;
  double tolerance;  // how far apart is together; 0: a millionth of the diagonal
} arap_repairs;

typedef struct arap_mesh_options {
  size_t size;
  int32_t basis, weights;  // default: EDGE, UNIFORM
  const double* rigidity;  // #F, or NULL: 1 everywhere
  arap_repairs repairs;
} arap_mesh_options;

// Mends, checks and factors a planar mesh: `vertices` is #V × 2, `triangles` #F × 3. `mesh_id`
// NULL: one made of its content. `out` may be NULL.
arap_error* arap_register_mesh(const arap_session* session, const char* mesh_id,
                               const double* vertices, size_t vertex_count,
                               const uint32_t* triangles, size_t triangle_count,
                               const arap_mesh_options* options, const arap_call_options* call,
                               arap_mesh** out);
const char* arap_mesh_id(const arap_mesh* mesh);
size_t arap_mesh_vertex_count(const arap_mesh* mesh);
size_t arap_mesh_triangle_count(const arap_mesh* mesh);
size_t arap_mesh_component_count(const arap_mesh* mesh);
double arap_mesh_area(const arap_mesh* mesh);
const arap_warnings* arap_mesh_warnings(const arap_mesh* mesh);
void arap_mesh_free(arap_mesh* mesh);

// ---- Handles ----

typedef struct arap_handle_set arap_handle_set;

enum { ARAP_AT_VERTEX, ARAP_IN_TRIANGLE, ARAP_AT_POINT };

typedef struct arap_handle {
  const char* id;      // unique in the set, 1 to 128 characters of [A-Za-z0-9._-]
  int32_t where;       // ARAP_AT_VERTEX, ARAP_IN_TRIANGLE or ARAP_AT_POINT
  uint32_t index;      // of the vertex or the triangle
  double at[3];        // barycentric coordinates in the triangle, or x and y of the point
  double weight;       // on the squared distance, 1e-6 to 1e12; 0: 1e6
  int32_t hard;        // 1: the target is met exactly
  int32_t oriented;    // 1: angle and scale of the target are held too
  int32_t snap;        // 1: a point outside the mesh goes to the nearest point of its boundary
  double area_radius;  // hold every vertex within this distance; implies oriented
  double depth, depth_falloff;  // for the drawing order; see arap/model/handle.h
} arap_handle;

// Where a handle should go. Mind the scale: 1 is as at rest, and 0 shrinks an oriented handle to a
// point.
typedef struct arap_target {
  const char* handle_id;
  double x, y;
  double angle, scale;  // of oriented handles, against the rest pose
} arap_target;

// Makes a set of handles on a mesh. `out` may be NULL.
arap_error* arap_compile_handles(const arap_session* session, const char* handle_set_id,
                                 const char* mesh_id, const arap_handle* handles,
                                 size_t handle_count, const arap_call_options* call,
                                 arap_handle_set** out);
// Removes first, then adds. Nothing changes when it fails. `out` may be NULL.
arap_error* arap_edit_handles(const arap_session* session, const char* handle_set_id,
                              const char* const* remove, size_t remove_count,
                              const arap_handle* add, size_t add_count,
                              const arap_call_options* call, arap_handle_set** out);
size_t arap_handle_set_count(const arap_handle_set* set);
// #H × 2: where the handles are at rest, in the order of arap_stream_move.
const double* arap_handle_set_rest(const arap_handle_set* set);
// NULL past the end.
const char* arap_handle_set_handle_id(const arap_handle_set* set, size_t index);
// Grows by one with every edit.
uint64_t arap_handle_set_revision(const arap_handle_set* set);
const arap_warnings* arap_handle_set_warnings(const arap_handle_set* set);
void arap_handle_set_free(arap_handle_set* set);

// ---- Shapes ----

typedef struct arap_shape arap_shape;

enum { ARAP_MODE_DEFAULT, ARAP_MODE_RIGID, ARAP_MODE_SIMILARITY, ARAP_MODE_BASELINE };
// How positions travel (arap/model/encoding.h).
enum { ARAP_ENCODING_DEFAULT, ARAP_FLOAT32, ARAP_FLOAT32_LE, ARAP_INT16_LE };

typedef struct arap_shape_options {
  size_t size;
  int32_t mode;                   // what is minimised (arap/model/deform.h); default RIGID
  int32_t refine;                 // repetitions of the second step, 0 to 1000
  int32_t float64;                // 1: positions in double precision on the wire, else in single
  int32_t flipped_ids;            // 1: also the ids of flipped triangles
  int32_t encoding;               // INT16_LE takes half the bytes of the others; not with float64
  int32_t boundary_only;          // 1: only vertices on the boundary, ascending
  const uint32_t* vertex_subset;  // or only these, in this order, none of them twice
  size_t vertex_subset_count;
} arap_shape_options;

// How good a shape is.
typedef struct arap_quality {
  uint64_t flipped;                  // triangles with reversed orientation
  double worst_handle_error;         // distance from the target
  double energy;                     // normalised to a unit diagonal, without handles
  double mean_stretch, max_stretch;  // of max(s1, 1/s2) over triangles, weighted with area
} arap_quality;

// One shape: a target for every handle of the set, in any order.
arap_error* arap_deform(const arap_session* session, const char* handle_set_id,
                        const arap_target* targets, size_t target_count,
                        const arap_shape_options* options, const arap_call_options* call,
                        arap_shape** out);
size_t arap_shape_vertex_count(const arap_shape* shape);       // #V, or as many as were asked for
const double* arap_shape_positions(const arap_shape* shape);   // as many × 2
const uint32_t* arap_shape_vertices(const arap_shape* shape);  // which they are; NULL: all
// How far a coordinate may be off by its way over the wire.
double arap_shape_position_error(const arap_shape* shape);
arap_quality arap_shape_quality(const arap_shape* shape);
// The handle that is farthest from its target, "" without handles.
const char* arap_shape_worst_handle(const arap_shape* shape);
size_t arap_shape_flipped_count(const arap_shape* shape);  // 0 unless flipped_ids was asked
const uint32_t* arap_shape_flipped(const arap_shape* shape);
uint64_t arap_shape_sequence(const arap_shape* shape);  // of the update that it answers
// Updates that newer ones replaced since the last answer.
uint64_t arap_shape_replaced(const arap_shape* shape);
uint64_t arap_shape_revision(const arap_shape* shape);  // of the handle set
void arap_shape_free(arap_shape* shape);

// ---- Streams ----

typedef struct arap_stream arap_stream;
typedef struct arap_event arap_event;
typedef struct arap_stream_options {
  size_t size;
  int32_t every;  // 1: every update is answered; else a new one replaces one that has not started
  const arap_shape_options* shape;
  int64_t heartbeat_ms;  // silence after which a sign of life is asked for; 0: 5 s; below 0: never
  int64_t silence_ms;    // silence after which the server counts as gone; 0: 30 s
  int64_t answer_ms;     // how long anything may be without its answer; 0: 10 min
  int64_t resume_within_ms;  // how long a lost stream is opened again and again; 0: not at all
} arap_stream_options;

// Opens a live stream on a handle set, and waits until the server has opened it. The timeout of
// `call` is that of the whole stream.
arap_error* arap_open_stream(const arap_session* session, const char* handle_set_id,
                             const arap_stream_options* options, const arap_call_options* call,
                             arap_stream** out);
// Moves all handles: `positions` is #H × 2 in the order of the set; angles and scales stay.
// `sequence` grows with every move and edit, and answers repeat it. Waits until the transport has
// taken it. PROTOCOL: the stream is over; arap_stream_take says why.
arap_error* arap_stream_move(arap_stream* stream, uint64_t sequence, const double* positions,
                             size_t handle_count);
// Moves some handles, with their angles and scales; the others stay where they are.
arap_error* arap_stream_move_some(arap_stream* stream, uint64_t sequence,
                                  const arap_target* targets, size_t target_count);
// Changes the handles of this stream, removals first. The answer is a shape with a new revision.
arap_error* arap_stream_edit(arap_stream* stream, uint64_t sequence, const char* const* remove,
                             size_t remove_count, const arap_handle* add, size_t add_count);
// Nothing more will be sent. What is pending is answered, then the stream ends.
arap_error* arap_stream_close_sending(arap_stream* stream);
// Ends the stream at once; a waiting take answers CANCELLED.
void arap_stream_cancel(arap_stream* stream);
// Cancels a stream that was not read to its end.
void arap_stream_free(arap_stream* stream);

enum {
  ARAP_EVENT_END,      // the stream ended well; so do all further takes
  ARAP_EVENT_SHAPE,    // arap_event_shape
  ARAP_EVENT_REFUSED,  // a bad move or edit, arap_event_error; the stream goes on
  ARAP_EVENT_RESUMED   // the stream was lost and goes on, perhaps on another server
};

// Waits for the next event. An error: the stream is broken, and stays so.
arap_error* arap_stream_take(arap_stream* stream, arap_event** out);
int32_t arap_event_kind(const arap_event* event);
// Of SHAPE and REFUSED the number of what it answers, else 0.
uint64_t arap_event_sequence(const arap_event* event);
// Parts of the event; NULL for other kinds.
const arap_shape* arap_event_shape(const arap_event* event);
const arap_error* arap_event_error(const arap_event* event);
void arap_event_free(arap_event* event);

// ---- Flattening ----

typedef struct arap_flat arap_flat;
enum {
  ARAP_FLATTEN_DEFAULT,
  ARAP_FLATTEN_ARAP,
  ARAP_FLATTEN_FIRST_STEP,
  ARAP_FLATTEN_LSCM,
  ARAP_FLATTEN_ABF
};

typedef struct arap_pin {
  uint32_t vertex;
  double u, v;
  double weight;  // 0: exactly; else on the squared distance, 1e-9 to 1e9
} arap_pin;

// The direction from one vertex to another, at this angle from the u axis.
typedef struct arap_grain {
  uint32_t from, to;
  double angle;
} arap_grain;

typedef struct arap_flatten_options {
  size_t size;
  int32_t method;               // default ARAP
  int32_t basis;                // FACE, EDGE or EDGE_AS_PUBLISHED; default: the method's
  int32_t refine;               // iterations at most; 0: as many as the method takes; below 0: none
  int32_t injective;            // 1: no flipped triangle, or NOT_INJECTIVE
  int32_t auto_cut;             // 1: cut whatever is then no disk
  int32_t split_non_manifold;   // 1: edges of three or more triangles are cut apart
  int32_t tolerate_degenerate;  // 1: triangles without area are let through
  int32_t float64;              // 1: uv in double precision on the wire, else in single
  arap_repairs repairs;
  const uint32_t* seams;  // edges to cut: seam_count × 2 vertices
  size_t seam_count;
  const arap_pin* pins;
  size_t pin_count;
  const arap_grain* grains;  // at most one per chart
  size_t grain_count;
  const double* rigidity;  // #F, or NULL: 1 everywhere
} arap_flatten_options;

// How far from an isometry (arap/model/flatten.h).
typedef struct arap_distortion {
  double arap_energy, symmetric_dirichlet, area_ratio;
  double mean_stretch_percent, max_stretch_percent;
  double mean_compression_percent, max_compression_percent;
  double mean_angle_degrees, max_angle_degrees;
  uint64_t flipped;
  uint32_t worst_triangle;
} arap_distortion;

// Lays a surface flat, true to size: `vertices` is #V × 3, `triangles` #F × 3. Needs no session.
arap_error* arap_flatten(const arap_client* client, const double* vertices, size_t vertex_count,
                         const uint32_t* triangles, size_t triangle_count,
                         const arap_flatten_options* options, const arap_call_options* call,
                         arap_flat** out);
// #U, at least #V: a vertex has a copy on each side of a cut.
size_t arap_flat_count(const arap_flat* flat);
const double* arap_flat_uv(const arap_flat* flat);         // #U × 2
const uint32_t* arap_flat_source(const arap_flat* flat);   // #U: the vertex that each is of
const uint32_t* arap_flat_corners(const arap_flat* flat);  // #F × 3 indices of uv
const uint32_t* arap_flat_charts(const arap_flat* flat);   // #F: the chart of every triangle
size_t arap_flat_chart_count(const arap_flat* flat);
// The boundaries of a chart, the longest first: indices of uv in order. 0 and NULL past the end.
size_t arap_flat_loop_count(const arap_flat* flat, size_t chart);
size_t arap_flat_loop_length(const arap_flat* flat, size_t chart, size_t loop);
const uint32_t* arap_flat_loop(const arap_flat* flat, size_t chart, size_t loop);
arap_distortion arap_flat_distortion(const arap_flat* flat);
int32_t arap_flat_overlaps(const arap_flat* flat);  // 1: boundaries cross
const arap_warnings* arap_flat_warnings(const arap_flat* flat);
void arap_flat_free(arap_flat* flat);

#ifdef __cplusplus
}
#endif
// NOLINTEND(readability-identifier-naming, modernize-use-using)
