// Deformer::Update does not touch the heap once it is warm, and memory that runs out is a fault. This
// program counts every malloc in the process, those of new, of Eigen and of CHOLMOD alike, and can
// refuse one.
#include <atomic>
#include <cstddef>

#include "core/base/try.h"
#include "tests/core/deform/fixture.h"
#include "tests/support/meshes.h"

namespace {
std::atomic<long> allocations{0};
std::atomic<long> refused{-1};  // the allocation that is not granted
}  // namespace

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define ARAP_COUNTS_MALLOC 0  // sanitizers own malloc
#else
#define ARAP_COUNTS_MALLOC 1
namespace {
bool Granted() { return ++allocations != refused; }
}  // namespace
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* malloc(std::size_t size) noexcept { return Granted() ? __libc_malloc(size) : nullptr; }
void* calloc(std::size_t count, std::size_t size) noexcept {
  return Granted() ? __libc_calloc(count, size) : nullptr;
}
void* realloc(void* old, std::size_t size) noexcept {
  return Granted() ? __libc_realloc(old, size) : nullptr;
}
}
#endif

namespace arap::testing {
namespace {

TEST(AllocationTest, AWarmUpdateDoesNotAllocate) {
  if (!ARAP_COUNTS_MALLOC) GTEST_SKIP() << "the sanitizer owns malloc";
  for (const Basis basis : {Basis::kEdge, Basis::kFace, Basis::kVertex}) {
    for (const std::size_t handles : {2u, 8u, 60u, 120u}) {
      const PlanarMesh mesh = JitteredGrid(30, 30, 2);
      const long unwarmed = allocations;
      auto given = RandomHandles(mesh, handles, 5);
      for (std::size_t i = 0; i < given.size(); i += 40) given[i].hard = true;
      const auto set = Compile(Register(mesh, basis), given);
      Deformer deformer(set);
      const auto targets = RandomTargets(*set, 3, 1), others = RandomTargets(*set, 9, 2);
      ASSERT_TRUE(deformer.Update(targets).has_value());
      ASSERT_GT(allocations - unwarmed, 10) << "the counter is not in the way of malloc";
      const long before = allocations;
      for (int i = 0; i < 3; ++i) {
        ASSERT_TRUE(deformer.Update(others, {DeformMode::kRigid, 2}).has_value());
        ASSERT_TRUE(deformer.Update(targets, {DeformMode::kBaseline, 0}).has_value());
        ASSERT_TRUE(deformer.Update(others, {DeformMode::kSimilarity, 0}).has_value());
      }
      EXPECT_EQ(allocations - before, 0) << handles << " handles";

      Deformer second(set);
      ASSERT_TRUE(second.Update(targets).has_value());
      const long before_both = allocations;
      for (int i = 0; i < 3; ++i) {
        JointFrame one{deformer, others, {DeformMode::kRigid, 2}, {}, {}};
        JointFrame other{second, targets, {}, {}, {}};
        UpdateTogether(one, other);
        ASSERT_TRUE(one.quality && other.quality);
      }
      EXPECT_EQ(allocations - before_both, 0) << handles << " handles";
    }
  }
}

// Refuses one allocation after the other of `job`, until it needs no more.
template <class Job>
void RefuseEach(Job job) {
  long faults = 0;
  for (long nth = 1;; ++nth) {
    refused = allocations + nth;
    const auto made = job();
    const bool was_refused = allocations >= refused;
    refused = -1;
    if (!was_refused) {
      EXPECT_TRUE(made.has_value());
      break;
    }
    // Some libraries ask for less when they cannot have much.
    if (made.has_value()) continue;
    ++faults;
    ASSERT_EQ(made.error().kind, FaultKind::kOutOfMemory) << nth << ": " << made.error().message;
  }
  EXPECT_GT(faults, 20);
}

TEST(OutOfMemoryTest, IsAFaultOfRegistrationAndCompilation) {
  if (!ARAP_COUNTS_MALLOC) GTEST_SKIP() << "the sanitizer owns malloc";
  const PlanarMesh mesh = JitteredGrid(5, 5, 2);
  // The first factorisation of a thread lets OpenMP take a little, once; factor.cc makes sure before
  // that there is more, because OpenMP ends the process where it gets nothing.
  Register(mesh);
  RefuseEach([&] { return OrOutOfMemory([&] { return RegisteredMesh::Register(mesh, {}); }); });
  const auto registered = Register(mesh);
  auto handles = RandomHandles(mesh, 6, 5);
  handles[0].depth = 1;
  handles[1].hard = true;
  for (const HandleSolver solver : {HandleSolver::kNullSpace, HandleSolver::kDirect}) {
    RefuseEach([&] {
      return OrOutOfMemory(
          [&] { return CompiledHandles::Compile(registered, handles, {}, solver); });
    });
  }
}

}  // namespace
}  // namespace arap::testing
