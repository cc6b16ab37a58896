// Deformer::Update does not touch the heap once it is warm. This program counts every malloc in the
// process: those of new, of Eigen and of CHOLMOD alike.
#include <atomic>
#include <cstddef>

#include "tests/core/deform/fixture.h"
#include "tests/support/meshes.h"

namespace {
std::atomic<long> allocations{0};
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define ARAP_COUNTS_MALLOC 0  // sanitizers own malloc
#else
#define ARAP_COUNTS_MALLOC 1
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* malloc(std::size_t size) noexcept {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
  ++allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) noexcept {
  ++allocations;
  return __libc_realloc(old, size);
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
    }
  }
}

}  // namespace
}  // namespace arap::testing
