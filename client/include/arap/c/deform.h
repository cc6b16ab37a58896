// Part of arap/c/arap_c.h, which see: meshes, handles, shapes, tracks and live streams.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "arap/c/base.h"

// NOLINTBEGIN(readability-identifier-naming, modernize-use-using): this is C.
#ifdef __cplusplus
extern "C" {
#endif

// ---- Meshes ----

typedef struct arap_mesh arap_mesh;
// How much an edge counts.
enum { ARAP_WEIGHTS_DEFAULT, ARAP_WEIGHTS_UNIFORM, ARAP_WEIGHTS_COTANGENT };

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
  // Which shapes of a stream or track are measured: the first, and every n-th after one that was; 0
  // and 1 all, below 0 none.
  int32_t measure_every;
} arap_shape_options;

// How good a shape is.
typedef struct arap_quality {
  uint64_t flipped;                  // triangles with reversed orientation
  double worst_handle_error;         // distance from the target
  double energy;                     // normalised to a unit diagonal, without handles
  double mean_stretch, max_stretch;  // of max(s1, 1/s2) over triangles, weighted with area
} arap_quality;

// Where a point of a deformed shape was at rest.
typedef struct arap_pick {
  int32_t hit;            // 0: nothing lies there, and the rest is 0
  uint32_t triangle;      // of the mesh as it was sent
  double barycentric[3];  // in it, in the order of its corners
  double x, y;            // the point at rest
} arap_pick;

// One shape: a target for every handle of the set, in any order.
arap_error* arap_deform(const arap_session* session, const char* handle_set_id,
                        const arap_target* targets, size_t target_count,
                        const arap_shape_options* options, const arap_call_options* call,
                        arap_shape** out);
// The same, and where points of the shape were at rest: `points` is point_count × 2, at most 1024.
arap_error* arap_deform_and_pick(const arap_session* session, const char* handle_set_id,
                                 const arap_target* targets, size_t target_count,
                                 const double* points, size_t point_count,
                                 const arap_shape_options* options, const arap_call_options* call,
                                 arap_shape** out);
size_t arap_shape_vertex_count(const arap_shape* shape);       // #V, or as many as were asked for
const double* arap_shape_positions(const arap_shape* shape);   // as many × 2
const uint32_t* arap_shape_vertices(const arap_shape* shape);  // which they are; NULL: all
// How far a coordinate may be off by its way over the wire.
double arap_shape_position_error(const arap_shape* shape);
arap_quality arap_shape_quality(const arap_shape* shape);
// 0: it was not measured. Only worst_handle_error of its quality says anything then.
int32_t arap_shape_is_measured(const arap_shape* shape);
// The handle that is farthest from its target, "" without handles.
const char* arap_shape_worst_handle(const arap_shape* shape);
size_t arap_shape_flipped_count(const arap_shape* shape);  // 0 unless flipped_ids was asked
const uint32_t* arap_shape_flipped(const arap_shape* shape);
size_t arap_shape_pick_count(const arap_shape* shape);  // one for each point that was asked for
arap_pick arap_shape_pick(const arap_shape* shape, size_t index);  // no hit past the end
// Of the update that it answers, or the number of the frame.
uint64_t arap_shape_sequence(const arap_shape* shape);
// Updates that newer ones replaced since the last answer.
uint64_t arap_shape_replaced(const arap_shape* shape);
uint64_t arap_shape_revision(const arap_shape* shape);  // of the handle set
void arap_shape_free(arap_shape* shape);

// ---- Tracks ----

// Is given the frames of a track in order, on the thread that asked for them. The shape is there
// until this returns. 1: go on; 0: stop. May neither throw nor jump out.
typedef int32_t (*arap_frame_callback)(void* user, const arap_shape* shape);

// A whole track: `positions` is #frames × #H × 2, with the handles in the order of `handle_ids`,
// which names every handle of the set once. `turns` is #frames × #H × 2 as well: the angle and the
// scale of oriented handles; NULL: 0 and 1 everywhere. CANCELLED when `on_frame` stops it, which
// gets `user` as it is. A frame that takes more than 10 min ends the track.
arap_error* arap_deform_track(const arap_session* session, const char* handle_set_id,
                              const char* const* handle_ids, size_t handle_count,
                              const double* positions, const double* turns, size_t frame_count,
                              const arap_shape_options* options, arap_frame_callback on_frame,
                              void* user, const arap_call_options* call);

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
// The same, perhaps of no handle, and the shape tells where points of it were at rest: `points` is
// point_count × 2, at most 1024.
arap_error* arap_stream_move_and_pick(arap_stream* stream, uint64_t sequence,
                                      const arap_target* targets, size_t target_count,
                                      const double* points, size_t point_count);
// Moves nothing, and asks for a shape that is measured whatever measure_every says: the quality of
// what stays where a hand rests. It may come with the answer to a newer move.
arap_error* arap_stream_measure(arap_stream* stream, uint64_t sequence);
// Changes the handles of this stream, removals first. The answer is a shape with a new revision,
// always measured.
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

#ifdef __cplusplus
}
#endif
// NOLINTEND(readability-identifier-naming, modernize-use-using)
