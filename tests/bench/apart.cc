#include "tests/bench/apart.h"

#include <array>
#include <cmath>
#include <csignal>
#include <fstream>
#include <string>

#include <malloc.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/bench/contenders.h"

namespace arap::bench {
namespace {

using Json = nlohmann::ordered_json;

[[noreturn]] void Child(int out, double budget, const std::function<Json()>& work) {
  const auto seconds = static_cast<rlim_t>(std::ceil(budget));
  const rlimit limit{seconds, seconds};
  if (setrlimit(RLIMIT_CPU, &limit) != 0) _exit(1);
  const std::string text = work().dump();
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t n = write(out, text.data() + done, text.size() - done);
    if (n <= 0) _exit(1);
    done += static_cast<std::size_t>(n);
  }
  _exit(0);
}

std::string ReadAll(int in) {
  std::string text;
  std::array<char, 4096> buffer{};
  for (ssize_t n = 0; (n = read(in, buffer.data(), buffer.size())) > 0;) {
    text.append(buffer.data(), static_cast<std::size_t>(n));
  }
  return text;
}

}  // namespace

std::optional<Json> RunApart(double budget, const std::function<Json()>& work) {
  std::array<int, 2> pipes{};
  std::fflush(nullptr);
  malloc_trim(0);
  if (pipe(pipes.data()) != 0) Die("no pipe");
  const pid_t child = fork();
  if (child < 0) Die("no process");
  if (child == 0) Child(pipes[1], budget, work);
  close(pipes[1]);
  const std::string text = ReadAll(pipes[0]);
  close(pipes[0]);
  int status = 0;
  waitpid(child, &status, 0);
  const bool ended = WIFSIGNALED(status);
  if (ended && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL)) return std::nullopt;
  if (ended || WEXITSTATUS(status) != 0) Die("a measured process failed");
  return Json::parse(text);
}

PeakMemory::PeakMemory() {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";  // the peak begins here
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages >> pages;
  before_ = pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

std::size_t PeakMemory::Growth() const {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const std::size_t peak = static_cast<std::size_t>(usage.ru_maxrss) * 1024;
  return peak > before_ ? peak - before_ : 0;
}

}  // namespace arap::bench
