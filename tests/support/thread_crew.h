// A crew of so many threads, that of the caller among them, which begin and end with every piece of work.
#pragma once

#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

#include "arap/base/crew.h"

namespace arap::testing {

class ThreadCrew final : public Crew {
 public:
  explicit ThreadCrew(std::size_t threads) : threads_(threads) {}

  // That the crew was given, of all pieces.
  std::size_t parts() const { return parts_; }

 private:
  void RunParts(std::size_t parts, Call call, const void* part) override {
    parts_ += parts;
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
      for (std::size_t i = next++; i < parts; i = next++) call(part, i);
    };
    std::vector<std::thread> others;
    for (std::size_t i = 1; i < threads_; ++i) others.emplace_back(work);
    work();
    for (std::thread& other : others) other.join();
  }

  std::size_t threads_;
  std::size_t parts_ = 0;
};

}  // namespace arap::testing
