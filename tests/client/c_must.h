/* How the program in C says what is not as it should be, and what it works on. */
#pragma once

#include <stdio.h>
#include <string.h>

#include "arap/c/arap_c.h"

static char failure[1024];

#define TEXT_OF(x) #x
#define LINE_TEXT(x) TEXT_OF(x)
/* Ends the function with the condition that does not hold. */
#define MUST(condition)                                                        \
  do {                                                                         \
    if (!(condition)) return __FILE__ ":" LINE_TEXT(__LINE__) ": " #condition; \
  } while (0)
/* Ends the function with the error, if there is one. */
#define WELL(call)                                                             \
  do {                                                                         \
    arap_error* well_error = (call);                                           \
    if (well_error != NULL) {                                                  \
      snprintf(failure, sizeof failure, "line %d: %s: %s", __LINE__,           \
               arap_error_reason(well_error), arap_error_message(well_error)); \
      arap_error_free(well_error);                                             \
      return failure;                                                          \
    }                                                                          \
  } while (0)
/* The call has to fail with this reason and field. */
#define REFUSED(call, reason, field)                                             \
  do {                                                                           \
    arap_error* refused_error = (call);                                          \
    MUST(refused_error != NULL);                                                 \
    const int as_said = strcmp(arap_error_reason(refused_error), reason) == 0 && \
                        strcmp(arap_error_field(refused_error), field) == 0 &&   \
                        strlen(arap_error_message(refused_error)) > 5;           \
    snprintf(failure, sizeof failure, "line %d: %s, field '%s': %s", __LINE__,   \
             arap_error_reason(refused_error), arap_error_field(refused_error),  \
             arap_error_message(refused_error));                                 \
    arap_error_free(refused_error);                                              \
    if (!as_said) return failure;                                                \
  } while (0)

/* Two squares side by side: 3 - 4 - 5 above 0 - 1 - 2. */
static const double kPlane[] = {0, 0, 1, 0, 2, 0, 0, 1, 1, 1, 2, 1};
static const uint32_t kTriangles[] = {0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4};
/* The same, bent by a right angle at the middle. */
static const double kBent[] = {0, 0, 0, 1, 0, 0, 1, 0, 1, 0, 1, 0, 1, 1, 0, 1, 1, 1};
enum { kVertices = 6, kTriangleCount = 4 };

static const arap_handle kHandles[] = {
    {.id = "left", .where = ARAP_AT_VERTEX, .index = 0, .hard = 1},
    {.id = "right", .where = ARAP_AT_POINT, .at = {2, 0.5}},
    {.id = "middle", .where = ARAP_IN_TRIANGLE, .index = 1, .at = {0.5, 0.5, 0}},
};

/* A session with the mesh "mesh" and the handles "set". */
const char* CPrepare(const char* address, arap_client** client, arap_session** session);
