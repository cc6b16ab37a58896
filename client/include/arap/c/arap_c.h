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
// their time is over. Callbacks run on the thread that called, within the call.
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

#include "arap/c/base.h"
#include "arap/c/deform.h"
#include "arap/c/flatten.h"
