// Part of arap/c/arap_c.h, which see: outlines, flattening with drawings, and jobs of it.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "arap/c/base.h"

// NOLINTBEGIN(readability-identifier-naming, modernize-use-using): this is C.
#ifdef __cplusplus
extern "C" {
#endif

// ---- Outlines ----

typedef struct arap_outline_mesh arap_outline_mesh;

// What becomes of curves before they are filled, in their unit (arap/model/outline.h).
typedef struct arap_outline_options {
  size_t size;
  uint32_t vertices;  // about; 0: 1000
  double tolerance;   // simplify by so much at most; 0: every point is kept
  double expansion;   // grow outwards by so much
} arap_outline_options;

// Well-shaped triangles inside closed curves: a mesh to register. `options` may be NULL. `points` has the curves one after the other, the first point of each not repeated;
// `lengths[i]` is how many points the curve i has. Curves inside of others are holes, and the other
// way round. Needs no session.
arap_error* arap_mesh_outline(const arap_client* client, const double* points,
                              const size_t* lengths, size_t outline_count,
                              const arap_outline_options* options, const arap_call_options* call,
                              arap_outline_mesh** out);
size_t arap_outline_mesh_vertex_count(const arap_outline_mesh* mesh);
const double* arap_outline_mesh_vertices(const arap_outline_mesh* mesh);  // #V × 2
size_t arap_outline_mesh_triangle_count(const arap_outline_mesh* mesh);
const uint32_t* arap_outline_mesh_triangles(const arap_outline_mesh* mesh);  // #F × 3
size_t arap_outline_mesh_piece_count(const arap_outline_mesh* mesh);
size_t arap_outline_mesh_hole_count(const arap_outline_mesh* mesh);      // of all pieces
double arap_outline_mesh_smallest_angle(const arap_outline_mesh* mesh);  // in degrees
// How far its border is at most from that of what was asked for.
double arap_outline_mesh_outline_error(const arap_outline_mesh* mesh);
void arap_outline_mesh_free(arap_outline_mesh* mesh);

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

enum { ARAP_SVG, ARAP_DXF, ARAP_PDF };
// How an allowance goes round a corner (arap/model/drawing.h).
enum { ARAP_CORNERS_DEFAULT, ARAP_CORNERS_MITRE, ARAP_CORNERS_SQUARE, ARAP_CORNERS_ROUND };

// A drawing at true size; lengths are in millimetres.
typedef struct arap_drawing_options {
  size_t size;
  int32_t format;               // ARAP_SVG, ARAP_DXF or ARAP_PDF
  double millimetres_per_unit;  // what a unit of the surface is; 0: 1
  double allowance;             // seam allowance round the pieces
  int32_t corners;              // of the allowance; default MITRE
  int32_t notches;              // 1: pair the sides of seams by short lines with a number
  double sheet_width;           // pack the pieces into a roll; 0: as they were laid
  const char* paper;            // "A4", "letter", "WIDTHxHEIGHT"…: pages; NULL: one piece
  double overlap, margin;  // of pages: with their neighbours, at the edge; 0: 10; below 0: none
  int32_t interior;        // 1: also the edges inside; of an SVG or PDF in one piece
  int32_t plain;           // 1: nothing besides the lines; of an SVG or PDF in one piece
} arap_drawing_options;

// Triangles from this one on, up to that of the next part, are called so in drawings.
typedef struct arap_part {
  uint32_t first_triangle;
  const char* name;  // NULL: nothing
} arap_part;

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
  const double* rigidity;                       // #F, or NULL: 1 everywhere
  const arap_drawing_options* const* drawings;  // also answer these, at most 16
  size_t drawing_count;
  const arap_part* parts;
  size_t part_count;
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
// Drawings, in the order of the options. Each is one file or, of an SVG on paper, the cover and the
// pages. Bytes are not ended by a 0. 0 and NULL past the end.
size_t arap_flat_drawing_count(const arap_flat* flat);
const arap_warnings* arap_flat_drawing_warnings(const arap_flat* flat, size_t drawing);
size_t arap_flat_file_count(const arap_flat* flat, size_t drawing);
const char* arap_flat_file_page(const arap_flat* flat, size_t drawing,
                                size_t file);  // "cover", "1"…
const char* arap_flat_file_bytes(const arap_flat* flat, size_t drawing, size_t file);
size_t arap_flat_file_size(const arap_flat* flat, size_t drawing, size_t file);
void arap_flat_free(arap_flat* flat);

// ---- Flattening as a job ----

typedef struct arap_job arap_job;

enum {
  ARAP_JOB_WAITING,
  ARAP_JOB_RUNNING,
  ARAP_JOB_DONE,
  ARAP_JOB_FAILED,  // arap_job_result says why
  ARAP_JOB_CANCELLED
};

// How a job stood when this was answered.
const char* arap_job_id(const arap_job* job);
int32_t arap_job_state(const arap_job* job);
const char* arap_job_phase(const arap_job* job);        // while it runs: "layout", "drawing", …
double arap_job_fraction(const arap_job* job);          // of the work; an estimate until it is 1
uint32_t arap_job_place(const arap_job* job);           // how many start before it, while it waits
double arap_job_expected_seconds(const arap_job* job);  // until it ends
uint64_t arap_job_result_bytes(const arap_job* job);    // when it is done
void arap_job_free(arap_job* job);

// Is told how a job stands, on the thread that watches it. The job is there until this returns. 1:
// go on; 0: stop watching. May neither throw nor jump out.
typedef int32_t (*arap_job_callback)(void* user, const arap_job* job);

// Begins a flattening that goes on by itself, also when the server is started anew, and lives as
// long as the session; the arguments are those of arap_flatten. Submitting it again with the same
// ones is harmless; ALREADY_EXISTS when the name has others. `out` may be NULL.
arap_error* arap_submit_flatten(const arap_session* session, const char* job_id,
                                const double* vertices, size_t vertex_count,
                                const uint32_t* triangles, size_t triangle_count,
                                const arap_flatten_options* options, const arap_call_options* call,
                                arap_job** out);
// Waits until the job has ended. `on_change` is called at once, when something has changed and
// every second or so, with `user` as it is; CANCELLED when it stops watching. It and `out` may be
// NULL.
arap_error* arap_watch_job(const arap_session* session, const char* job_id,
                           arap_job_callback on_change, void* user, const arap_call_options* call,
                           arap_job** out);
// The result of a job that is done, however large; the arguments are those that were submitted, and
// the result has to fit them. PROTOCOL while it is not done; the error of one that failed.
arap_error* arap_job_result(const arap_session* session, const char* job_id, const double* vertices,
                            size_t vertex_count, const uint32_t* triangles, size_t triangle_count,
                            const arap_flatten_options* options, const arap_call_options* call,
                            arap_flat** out);
// Ends a job that is not done; one that has ended stays as it is. `out` may be NULL.
arap_error* arap_cancel_job(const arap_session* session, const char* job_id,
                            const arap_call_options* call, arap_job** out);

#ifdef __cplusplus
}
#endif
// NOLINTEND(readability-identifier-naming, modernize-use-using)
