// Crew: threads that share the parts of one piece of work.
#pragma once

#include <algorithm>
#include <cstddef>

namespace arap {

// Who has threads to spare makes one and hands it to a call. What the call answers does not depend on it: parts are
// cut by the work alone, and what they answer is put together in their order.
class Crew {
 public:
  virtual ~Crew() = default;

  // Calls part(i) once for every i below `parts`, in any order and in several threads at once, that of the caller
  // among them. Returns when all have ended. `part` must not throw, lock or wait.
  template <class Part>
  void Run(std::size_t parts, const Part& part) {
    RunParts(
        parts, [](const void* self, std::size_t i) { (*static_cast<const Part*>(self))(i); },
        &part);
  }

 protected:
  using Call = void (*)(const void* part, std::size_t index);
  virtual void RunParts(std::size_t parts, Call call, const void* part) = 0;
};

// The same where there may be no crew (nullptr): in order, in this thread.
template <class Part>
void RunParts(Crew* crew, std::size_t parts, const Part& part) {
  if (crew != nullptr && parts > 1) return crew->Run(parts, part);
  for (std::size_t i = 0; i < parts; ++i) part(i);
}

// Calls range(begin, end) for neighbouring ranges of [0, size) of `step`, the last one shorter; without a crew for all
// at once, so that no result may depend on where they begin.
template <class Range>
void RunRanges(Crew* crew, std::size_t size, std::size_t step, const Range& range) {
  if (crew == nullptr) return range(std::size_t{0}, size);
  RunParts(crew, (size + step - 1) / step,
           [&](std::size_t i) { range(i * step, std::min((i + 1) * step, size)); });
}

// Where parts are added up, with a crew or without: the size of a part that cuts [0, size) into kMostParts at most, a
// multiple of `least`.
inline constexpr std::size_t kMostParts = 256;
constexpr std::size_t PartSize(std::size_t size, std::size_t least) {
  const std::size_t all = kMostParts * least;
  return least * std::max<std::size_t>((size + all - 1) / all, 1);
}

}  // namespace arap
