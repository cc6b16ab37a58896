// What the libraries below may not do in a thread of ours: threads of their own, and tiny numbers. For factor.cc only.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <mutex>
#include <new>

#include <dlfcn.h>

namespace arap {

// Parallelism is ours, by streams and jobs; a second layer inside BLAS would only fight with it and
// make results depend on the number of threads. Not every BLAS has the switch, so it is looked up.
inline void UseOneBlasThread() {
  static std::once_flag once;
  std::call_once(once, [] {
    using SetThreads = void (*)(int);
    if (void* symbol = dlsym(RTLD_DEFAULT, "openblas_set_num_threads")) {
      reinterpret_cast<SetThreads>(symbol)(1);
    }
  });
}

// While it lives OpenMP's parallel regions that this thread enters have one thread. CHOLMOD has such
// regions, too small to gain by them, and the threads that it wakes would wait for more work at full
// speed: a factorisation took twice its processor time. What the caller has set comes back.
class NoOpenMp {
 public:
  // std::bad_alloc where the first of a thread finds no memory: OpenMP takes 216 bytes then, and ends
  // the process when it does not get them.
  NoOpenMp() {
    if (!Calls().set || !Calls().get) return;
    thread_local bool known = false;
    if (!known) FindRoom();
    known = true;
    before_ = Calls().get();
    Calls().set(0);
  }
  ~NoOpenMp() {
    if (Calls().set && Calls().get) Calls().set(before_);
  }
  NoOpenMp(const NoOpenMp&) = delete;
  NoOpenMp& operator=(const NoOpenMp&) = delete;

 private:
  struct Functions {
    void (*set)(int);
    int (*get)();
  };
  // Far more than OpenMP takes right afterwards.
  static void FindRoom() {
    constexpr std::size_t kRoom = 16'384;
    void* const volatile room = std::malloc(kRoom);  // volatile: or the compiler leaves it out
    if (room == nullptr) throw std::bad_alloc();
    std::free(room);
  }
  // Not every CHOLMOD is built with OpenMP, so they are looked up.
  static const Functions& Calls() {
    static const Functions kCalls{
        reinterpret_cast<void (*)(int)>(dlsym(RTLD_DEFAULT, "omp_set_max_active_levels")),
        reinterpret_cast<int (*)()>(dlsym(RTLD_DEFAULT, "omp_get_max_active_levels"))};
    return kCalls;
  }

  int before_ = 0;
};

// While it lives numbers below 1e-308 are 0. The processor takes far longer for them, and a firm soft
// area makes many: the factorisation would take twice its time.
class NoDenormals {
#if defined(__x86_64__) && defined(__GNUC__)
 public:
  NoDenormals() { __builtin_ia32_ldmxcsr(before_ | kFlushToZero | kDenormalsAreZero); }
  ~NoDenormals() { __builtin_ia32_ldmxcsr(before_); }
  NoDenormals(const NoDenormals&) = delete;
  NoDenormals& operator=(const NoDenormals&) = delete;

 private:
  static constexpr unsigned kFlushToZero = 0x8000, kDenormalsAreZero = 0x40;
  const unsigned before_ = __builtin_ia32_stmxcsr();
#endif
};

}  // namespace arap
