// Wide: several machine codes for one hot loop, chosen at run time.
//
// Write the loop as an ARAP_WIDE_BODY function, make its wide twin with ARAP_WIDE, and call the
// twin when HasWide(); ARAP_WIDEST and HasWidest() for a third where registers of 512 bits pay. No
// fused multiply-add and no reassociation: the twins agree to the last bit.
#pragma once

// clang compiles the plain code only: it forgets in a reference that lanes lie anywhere (lanes.h), and moves them as if they
// lay on a multiple of their size.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define ARAP_HAS_WIDE 1
#endif

namespace arap {

#ifdef ARAP_HAS_WIDE
#define ARAP_WIDE_BODY [[gnu::always_inline]] inline
#define ARAP_WIDE(body, twin, parameters, arguments) \
  [[gnu::target("avx2")]] void twin parameters { body arguments; }
#define ARAP_WIDEST(body, twin, parameters, arguments) \
  [[gnu::target("avx512f,avx512vl,avx512dq")]] void twin parameters { body arguments; }
inline bool HasWide() { return __builtin_cpu_supports("avx2") != 0; }
// Not on the processors that slow down for it, which have no VBMI2.
inline bool HasWidest() {
  return __builtin_cpu_supports("avx512vl") != 0 && __builtin_cpu_supports("avx512dq") != 0 &&
         __builtin_cpu_supports("avx512vbmi2") != 0;
}
#else
#define ARAP_WIDE_BODY inline
#define ARAP_WIDE(body, twin, parameters, arguments) \
  void twin parameters { body arguments; }
#define ARAP_WIDEST(body, twin, parameters, arguments) ARAP_WIDE(body, twin, parameters, arguments)
inline bool HasWide() { return false; }
inline bool HasWidest() { return false; }
#endif

}  // namespace arap
