/* What a program in C does with arap_c.h: in a file of its own that the C compiler compiles. */
#pragma once

#ifdef __cplusplus
extern "C" {
#endif

/* Each goes through a part of the interface against the server at `address`. Answers NULL, or what was not
 * as it should be. */
const char* CDrag(const char* address);
const char* CEdits(const char* address);
const char* CPicks(const char* address);
const char* CTracks(const char* address);
const char* COutlines(const char* address);
const char* CFlatten(const char* address);
const char* CDrawings(const char* address);
const char* CJobs(const char* address);
const char* CRefusals(const char* address);
/* The same for what needs no server. */
const char* CBadArguments(void);

#ifdef __cplusplus
}
#endif
