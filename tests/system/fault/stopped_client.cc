// A client to be stopped by a signal: opens a stream on session "s", set "h" and drags the handle
// "a" without end, each update after the shape before it. Prints "shape N" for every 50th.
#include <cstdio>

#include "tests/system/fault/client.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: stopped_client ADDRESS\n");
    return 2;
  }
  using namespace arap;  // NOLINT(google-build-using-namespace): a program of ten lines
  fault::FaultClient client(argv[1]);
  wire::DeformStream stream(client.deformation());
  stream.Opened("s", "h", v1::DELIVERY_EVERY);
  for (std::uint64_t sequence = 1;; ++sequence) {
    stream.Update(sequence, {wire::TargetAt("a", 0, static_cast<double>(sequence % 7))});
    const auto answer = stream.Read();
    if (!answer || !answer->has_shape()) return 1;
    if (sequence % 50 == 0) {
      std::printf("shape %llu\n", static_cast<unsigned long long>(sequence));
      std::fflush(stdout);
    }
  }
}
