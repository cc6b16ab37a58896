// Every input of the corpus through its target, and mutations of them: what the fuzzer once found
// stays found, with any compiler.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/fuzz/targets.h"
#include "tests/support/random.h"

namespace arap::fuzz {

// GoogleTest finds it by its name.
static void PrintTo(const FuzzTarget& target, std::ostream* out) { *out << target.name; }

namespace {

using Input = std::vector<std::uint8_t>;

constexpr int kMutations = 400;  // of each target

Input Read(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

// By name, so that the mutations are the same everywhere.
std::vector<std::filesystem::path> Corpus(const std::string& target) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(ARAP_FUZZ_CORPUS "/" + target)) {
    paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

// One to eight small changes, or the head of one input with the tail of another.
Input Mutated(const Input& input, const Input& other, testing::Random& random) {
  Input mutated = input;
  if (random.Below(4) == 0 && !other.empty()) {
    mutated.resize(random.Below(mutated.size() + 1));
    mutated.insert(mutated.end(),
                   other.begin() + static_cast<std::ptrdiff_t>(random.Below(other.size())),
                   other.end());
  }
  for (std::size_t changes = 1 + random.Below(8); changes > 0; --changes) {
    const auto at = [&](std::size_t bound) {
      return static_cast<std::ptrdiff_t>(random.Below(bound));
    };
    const auto byte = static_cast<std::uint8_t>(random.Below(256));
    switch (mutated.empty() ? 0 : random.Below(4)) {
      case 0:
        mutated.insert(mutated.begin() + at(mutated.size() + 1), byte);
        break;
      case 1:
        mutated.erase(mutated.begin() + at(mutated.size()));
        break;
      case 2:
        mutated[random.Below(mutated.size())] ^= static_cast<std::uint8_t>(1u << random.Below(8));
        break;
      default:
        mutated[random.Below(mutated.size())] = byte;
        break;
    }
  }
  return mutated;
}

class ReplayTest : public ::testing::TestWithParam<FuzzTarget> {};

TEST_P(ReplayTest, Corpus) {
  const auto paths = Corpus(GetParam().name);
  ASSERT_FALSE(paths.empty());
  for (const auto& path : paths) {
    SCOPED_TRACE(path.string());
    const Input input = Read(path);
    GetParam().run(input.data(), input.size());
  }
}

TEST_P(ReplayTest, Mutations) {
  const auto paths = Corpus(GetParam().name);
  ASSERT_FALSE(paths.empty());
  testing::Random random(5);
  for (int i = 0; i < kMutations; ++i) {
    const Input input = Mutated(Read(paths[random.Below(paths.size())]),
                                Read(paths[random.Below(paths.size())]), random);
    GetParam().run(input.data(), input.size());
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, ReplayTest, ::testing::ValuesIn(kTargets),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace arap::fuzz
