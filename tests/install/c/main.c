/* Connects nowhere, from C. */
#include <arap/c/arap_c.h>
#include <stdio.h>
#include <string.h>

int main(void) {
  arap_client* client = NULL;
  arap_session* session = NULL;
  arap_call_options call = ARAP_OPTIONS(arap_call_options);
  call.retry_ms = -1;
  arap_error* error = arap_connect("unix:/nonexistent/arapd.sock", NULL, &client);
  if (error != NULL) return 1;
  error = arap_create_session(client, NULL, 0, &call, &session);
  if (error == NULL || strcmp(arap_error_reason(error), "DRAINING") != 0) return 2;
  puts(arap_error_message(error));
  arap_error_free(error);
  arap_client_free(client);
  return 0;
}
