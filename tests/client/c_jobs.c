#include <math.h>
#include <string.h>

#include "tests/client/c_calls.h"
#include "tests/client/c_must.h"

static int Begins(const arap_flat* flat, size_t drawing, size_t file, const char* with) {
  const size_t length = strlen(with);
  return arap_flat_file_size(flat, drawing, file) > length &&
         memcmp(arap_flat_file_bytes(flat, drawing, file), with, length) == 0;
}

const char* CDrawings(const char* address) {
  arap_client* client = NULL;
  WELL(arap_connect(address, NULL, &client));
  arap_drawing_options dxf = ARAP_OPTIONS(arap_drawing_options);
  dxf.format = ARAP_DXF;
  dxf.allowance = 10;
  dxf.corners = ARAP_CORNERS_ROUND;
  arap_drawing_options pages = ARAP_OPTIONS(arap_drawing_options);
  pages.paper = "A4";
  pages.millimetres_per_unit = 150;
  pages.overlap = -1;
  arap_drawing_options pdf = ARAP_OPTIONS(arap_drawing_options);
  pdf.format = ARAP_PDF;
  const arap_drawing_options* drawings[] = {&dxf, &pages, &pdf};
  const arap_part part = {0, "sleeve"};
  arap_flatten_options options = ARAP_OPTIONS(arap_flatten_options);
  options.drawings = drawings;
  options.drawing_count = 3;
  options.parts = &part;
  options.part_count = 1;
  arap_flat* flat = NULL;
  WELL(arap_flatten(client, kBent, kVertices, kTriangles, kTriangleCount, &options, NULL, &flat));
  MUST(arap_flat_drawing_count(flat) == 3);
  MUST(arap_flat_file_count(flat, 0) == 1 && Begins(flat, 0, 0, "  0\nSECTION\n"));
  MUST(strcmp(arap_flat_file_page(flat, 0, 0), "") == 0);
  MUST(arap_flat_file_count(flat, 1) >= 3 && Begins(flat, 1, 0, "<svg"));
  MUST(strcmp(arap_flat_file_page(flat, 1, 0), "cover") == 0);
  MUST(strcmp(arap_flat_file_page(flat, 1, 1), "1") == 0);
  MUST(arap_flat_file_count(flat, 2) == 1 && Begins(flat, 2, 0, "%PDF-"));
  MUST(arap_flat_drawing_warnings(flat, 2) != NULL);
  MUST(arap_flat_drawing_warnings(flat, 3) == NULL && arap_flat_file_count(flat, 3) == 0);
  MUST(arap_flat_file_bytes(flat, 2, 1) == NULL && arap_flat_file_size(flat, 2, 1) == 0);
  MUST(arap_flat_file_page(flat, 3, 0) == NULL);
  arap_flat_free(flat);

  flat = NULL;
  pages.paper = "B9";
  REFUSED(arap_flatten(client, kBent, kVertices, kTriangles, kTriangleCount, &options, NULL, &flat),
          "INVALID_OPTION", "drawings[1].paper");
  pages.paper = NULL;
  pages.corners = 4;
  REFUSED(arap_flatten(client, kBent, kVertices, kTriangles, kTriangleCount, &options, NULL, &flat),
          "INVALID_OPTION", "drawings[1].corners");
  dxf.format = -1;
  REFUSED(arap_flatten(client, kBent, kVertices, kTriangles, kTriangleCount, &options, NULL, &flat),
          "INVALID_OPTION", "drawings[0].format");
  dxf.size = 0;
  REFUSED(arap_flatten(client, kBent, kVertices, kTriangles, kTriangleCount, &options, NULL, &flat),
          "INVALID_OPTION", "drawings[0].size");
  drawings[0] = NULL;
  REFUSED(arap_flatten(client, kBent, kVertices, kTriangles, kTriangleCount, &options, NULL, &flat),
          "INVALID_OPTION", "drawings[0]");
  options.drawings = NULL;
  REFUSED(arap_flatten(client, kBent, kVertices, kTriangles, kTriangleCount, &options, NULL, &flat),
          "INVALID_OPTION", "drawings");
  options.drawing_count = 0;
  options.parts = NULL;
  REFUSED(arap_flatten(client, kBent, kVertices, kTriangles, kTriangleCount, &options, NULL, &flat),
          "INVALID_OPTION", "parts");
  MUST(flat == NULL);
  arap_client_free(client);
  return NULL;
}

typedef struct Seen {
  int count;
  int go_on;
  int right;
} Seen;

static int32_t See(void* user, const arap_job* job) {
  Seen* seen = (Seen*)user;
  ++seen->count;
  if (strcmp(arap_job_id(job), "job") != 0 || arap_job_state(job) < ARAP_JOB_WAITING ||
      arap_job_state(job) > ARAP_JOB_CANCELLED || arap_job_phase(job) == NULL ||
      !(arap_job_fraction(job) >= 0 && arap_job_fraction(job) <= 1) ||
      !(arap_job_expected_seconds(job) >= 0)) {
    seen->right = 0;
  }
  return seen->go_on;
}

const char* CJobs(const char* address) {
  arap_client* client = NULL;
  arap_session* session = NULL;
  WELL(arap_connect(address, NULL, &client));
  WELL(arap_create_session(client, NULL, 0, NULL, &session));
  arap_flatten_options options = ARAP_OPTIONS(arap_flatten_options);
  options.float64 = 1;
  arap_job* job = NULL;
  /* The same again is harmless. */
  for (int i = 0; i < 2; ++i) {
    WELL(arap_submit_flatten(session, "job", kBent, kVertices, kTriangles, kTriangleCount, &options,
                             NULL, &job));
    MUST(strcmp(arap_job_id(job), "job") == 0 && arap_job_place(job) < 1000);
    arap_job_free(job);
  }
  Seen seen = {0, 1, 1};
  WELL(arap_watch_job(session, "job", See, &seen, NULL, &job));
  MUST(seen.count > 0 && seen.right);
  MUST(arap_job_state(job) == ARAP_JOB_DONE && arap_job_fraction(job) == 1);
  MUST(arap_job_result_bytes(job) > 0);
  arap_job_free(job);
  WELL(arap_watch_job(session, "job", NULL, NULL, NULL, NULL));

  /* To the last bit what arap_flatten answers. */
  arap_flat* flat = NULL;
  arap_flat* direct = NULL;
  WELL(arap_job_result(session, "job", kBent, kVertices, kTriangles, kTriangleCount, &options, NULL,
                       &flat));
  WELL(arap_flatten(client, kBent, kVertices, kTriangles, kTriangleCount, &options, NULL, &direct));
  MUST(arap_flat_count(flat) == kVertices && arap_flat_count(direct) == kVertices);
  MUST(memcmp(arap_flat_uv(flat), arap_flat_uv(direct), 2 * kVertices * sizeof(double)) == 0);
  arap_flat_free(direct);
  arap_flat_free(flat);
  flat = NULL;

  /* What has ended stays as it is. */
  WELL(arap_cancel_job(session, "job", NULL, &job));
  MUST(arap_job_state(job) == ARAP_JOB_DONE);
  arap_job_free(job);
  job = NULL;
  WELL(arap_cancel_job(session, "job", NULL, NULL));

  /* A surface that is no disk: the job fails, and its result says why. */
  const double corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const uint32_t closed[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};
  WELL(arap_submit_flatten(session, "closed", corners, 4, closed, 4, NULL, NULL, NULL));
  WELL(arap_watch_job(session, "closed", NULL, NULL, NULL, &job));
  MUST(arap_job_state(job) == ARAP_JOB_FAILED);
  arap_job_free(job);
  job = NULL;
  REFUSED(arap_job_result(session, "closed", corners, 4, closed, 4, NULL, NULL, &flat),
          "NOT_A_DISK", "mesh.triangles");

  options.method = ARAP_FLATTEN_LSCM;
  REFUSED(arap_submit_flatten(session, "job", kBent, kVertices, kTriangles, kTriangleCount,
                              &options, NULL, &job),
          "ALREADY_EXISTS", "");
  seen = (Seen){0, 0, 1};
  REFUSED(arap_watch_job(session, "job", See, &seen, NULL, &job), "CANCELLED", "");
  MUST(seen.count == 1 && seen.right);
  REFUSED(arap_watch_job(session, "none", NULL, NULL, NULL, &job), "NOT_FOUND", "");
  REFUSED(arap_cancel_job(session, "none", NULL, &job), "NOT_FOUND", "");
  REFUSED(arap_job_result(session, "none", corners, 4, closed, 4, NULL, NULL, &flat), "NOT_FOUND",
          "");
  REFUSED(arap_submit_flatten(session, NULL, corners, 4, closed, 4, NULL, NULL, &job),
          "INVALID_OPTION", "job_id");
  REFUSED(arap_submit_flatten(session, "j", NULL, 4, closed, 4, NULL, NULL, &job), "INVALID_OPTION",
          "vertices");
  REFUSED(arap_watch_job(session, "no id", NULL, NULL, NULL, &job), "INVALID_NAME", "job_id");
  REFUSED(arap_cancel_job(NULL, "job", NULL, &job), "INVALID_OPTION", "session");
  REFUSED(arap_job_result(session, "job", corners, 4, closed, 4, NULL, NULL, NULL),
          "INVALID_OPTION", "out");
  MUST(job == NULL && flat == NULL);
  WELL(arap_delete_session(session, NULL));
  arap_session_free(session);
  arap_client_free(client);
  arap_job_free(NULL);
  return NULL;
}
