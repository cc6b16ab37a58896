// What all parts of arap/c/arap_c.h share, which see: errors, warnings, connections and sessions.
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

// ---- Shared by meshes and surfaces ----

// What a cell of the energy is (arap/model/energy.h).
enum {
  ARAP_BASIS_DEFAULT,
  ARAP_BASIS_EDGE,
  ARAP_BASIS_EDGE_AS_PUBLISHED,
  ARAP_BASIS_FACE,
  ARAP_BASIS_VERTEX
};

// What is mended first (arap/model/repair.h); members are 1 or 0.
typedef struct arap_repairs {
  int32_t weld, drop_duplicates, stitch;
  double tolerance;  // how far apart is together; 0: a millionth of the diagonal
} arap_repairs;

#ifdef __cplusplus
}
#endif
// NOLINTEND(readability-identifier-naming, modernize-use-using)
