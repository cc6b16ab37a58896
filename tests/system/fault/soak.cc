// A mixed load on a real arapd for a while: do its memory and its descriptors stay where they are?
//
// Usage: arap_soak [MINUTES]   (1 unless told). See script/soak.
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include <gtest/gtest.h>

#include "tests/system/fault/server_process.h"
#include "tests/system/fault/soak_load.h"
#include "tests/system/fault/trend.h"

namespace arap::fault {
namespace {

using std::chrono::seconds;
using std::chrono::steady_clock;

constexpr double kMegabyte = 1 << 20;

struct Samples {
  std::vector<double> megabytes;
  std::vector<double> descriptors;
};

void PrintRow(std::size_t second, const Samples& samples, const SoakLoad& load) {
  std::size_t done = 0, wrong = 0;
  for (const auto& count : load.counts()) {
    done += count->done;
    wrong += count->wrong;
  }
  std::printf("%7zu %10.1f %6.0f %9zu %7zu\n", second, samples.megabytes.back(),
              samples.descriptors.back(), done, wrong);
  std::fflush(stdout);
}

// A sample a second; a row now and then.
Samples Watch(const ServerProcess& server, const SoakLoad& load, std::size_t length) {
  Samples samples;
  const std::size_t rows = std::max<std::size_t>(1, length / 30);
  std::printf("%7s %10s %6s %9s %7s\n", "seconds", "memory MB", "files", "calls", "wrong");
  const auto start = steady_clock::now();
  for (std::size_t second = 1; second <= length; ++second) {
    Eventually([&] { return steady_clock::now() >= start + seconds(second); },
               std::chrono::hours(24));
    samples.megabytes.push_back(static_cast<double>(server.ResidentBytes()) / kMegabyte);
    samples.descriptors.push_back(static_cast<double>(server.Descriptors()));
    if (second % rows == 0) PrintRow(second, samples, load);
  }
  return samples;
}

// One line of the verdict: whether what rises stays below `allowed`.
bool Judge(const char* what, const std::vector<double>& samples, double allowed) {
  const auto settled = AfterWarmUp(samples);
  const double rise = Rise(settled);
  const auto [least, most] = std::minmax_element(settled.begin(), settled.end());
  const bool flat = rise <= allowed;
  std::printf("%-12s %9.1f %9.1f %9.1f %9.2f %9.2f  %s\n", what, Fit(settled).mean, *least, *most,
              rise, allowed, flat ? "flat" : "RISES");
  return flat;
}

bool Verdict(const Samples& samples, const SoakLoad& load) {
  std::printf("\n%-12s %9s %9s %9s\n", "load", "calls", "wrong", "");
  bool good = true;
  for (const auto& count : load.counts()) {
    std::printf("%-12s %9zu %9zu\n", count->what, count->done.load(), count->wrong.load());
    good = good && count->wrong == 0 && count->done > 0;
  }
  std::printf("\nThe last two thirds, by a straight line\n%-12s %9s %9s %9s %9s %9s\n", "", "mean",
              "least", "most", "rise", "allowed");
  // A leak of a byte per call would not be seen; one of a frame, a session or a stream would.
  const double memory = 2 + 0.03 * Fit(AfterWarmUp(samples.megabytes)).mean;
  const bool flat_memory = Judge("memory MB", samples.megabytes, memory);
  const bool flat_files = Judge("descriptors", samples.descriptors, 2);
  return good && flat_memory && flat_files;
}

int Soak(std::size_t length) {
  ServerProcess server({"--store", "sqlite:{}/store", "--access-log", "off"});
  if (!server.Start()) return 1;
  SoakLoad load(server.address());
  if (!load.good()) return 1;
  const Samples samples = Watch(server, load, length);
  load.Stop();
  const bool good = Verdict(samples, load);
  server.Signal(SIGTERM);
  const auto code = server.Wait(seconds(60));
  std::printf("\nThe server ended with code %d.\n", code.value_or(-1));
  return good && code == 0 && !::testing::Test::HasFailure() ? 0 : 1;
}

}  // namespace
}  // namespace arap::fault

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  const double minutes = argc > 1 ? std::strtod(argv[1], nullptr) : 1;
  if (argc > 2 || !(minutes > 0 && minutes <= 1e5)) {
    std::fprintf(stderr, "usage: arap_soak [MINUTES]\n");
    return 2;
  }
  return arap::fault::Soak(std::max<std::size_t>(10, static_cast<std::size_t>(minutes * 60)));
}
