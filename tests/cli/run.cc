#include "tests/cli/run.h"

#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <limits>

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/files/text_file.h"

namespace arap::cli {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr std::chrono::minutes kTimeout{5};

// Appends what there is to read; false at the end.
bool ReadSome(int descriptor, std::string& text) {
  std::array<char, 4096> buffer{};
  const ssize_t count = read(descriptor, buffer.data(), buffer.size());
  if (count > 0) text.append(buffer.data(), static_cast<std::size_t>(count));
  return count > 0 || (count < 0 && errno == EINTR);
}

// Reads both pipes to their ends, as a full one would stop the program; false when it is still
// running at the deadline.
bool ReadBoth(int out, int err, steady_clock::time_point deadline, Outcome& outcome) {
  std::array<pollfd, 2> pipes{{{out, POLLIN, 0}, {err, POLLIN, 0}}};
  while (pipes[0].fd >= 0 || pipes[1].fd >= 0) {
    const auto left = std::chrono::duration_cast<milliseconds>(deadline - steady_clock::now());
    if (left.count() <= 0) return false;
    if (poll(pipes.data(), pipes.size(), static_cast<int>(left.count())) < 0 && errno != EINTR) {
      return false;
    }
    if (pipes[0].revents != 0 && !ReadSome(out, outcome.out)) pipes[0].fd = -1;
    if (pipes[1].revents != 0 && !ReadSome(err, outcome.err)) pipes[1].fd = -1;
  }
  return true;
}

// Cuts off what comes before the first separator, or everything.
std::string_view Cut(std::string_view& text, char separator) {
  const std::size_t end = text.find(separator);
  const std::string_view piece = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return piece;
}

double Number(std::string_view text) {
  double value = std::numeric_limits<double>::quiet_NaN();
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

}  // namespace

Outcome Arapctl(const std::vector<std::string>& arguments, std::string_view input) {
  // Whoever runs the tests may have a config of their own.
  static const bool alone = [] {
    for (const char* variable : {"ARAPCTL_SERVER", "ARAPCTL_TOKEN", "ARAPCTL_CONFIG"}) {
      unsetenv(variable);
    }
    unsetenv("XDG_CONFIG_HOME");
    return setenv("HOME", "/nonexistent", 1) == 0;
  }();
  EXPECT_TRUE(alone);
  std::vector<std::string> words{ARAPCTL};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  std::array<int, 2> out{}, err{};
  EXPECT_EQ(pipe2(out.data(), O_CLOEXEC), 0);
  EXPECT_EQ(pipe2(err.data(), O_CLOEXEC), 0);
  // A file, so that nobody has to write while the outputs are read.
  const int in = memfd_create("input", MFD_CLOEXEC);
  EXPECT_EQ(write(in, input.data(), input.size()), static_cast<ssize_t>(input.size()));
  EXPECT_EQ(lseek(in, 0, SEEK_SET), 0);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, in, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, out[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, err[1], STDERR_FILENO);
  pid_t pid = -1;
  EXPECT_EQ(posix_spawn(&pid, argv[0], &actions, nullptr, argv.data(), environ), 0);
  posix_spawn_file_actions_destroy(&actions);
  close(in);
  close(out[1]);
  close(err[1]);

  Outcome outcome;
  if (!ReadBoth(out[0], err[0], steady_clock::now() + kTimeout, outcome)) {
    ADD_FAILURE() << "arapctl " << testing::PrintToString(arguments) << " did not end within "
                  << kTimeout.count() << " minutes";
    kill(pid, SIGKILL);
  }
  close(out[0]);
  close(err[0]);
  int status = 0;
  while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return outcome;
}

std::string Slurp(const std::string& path) {
  const Result<std::string> text = ReadTextFile(path);
  if (text) return *text;
  ADD_FAILURE() << text.error().message;
  return {};
}

Csv ParseCsv(std::string_view text) {
  Csv csv;
  csv.header = Cut(text, '\n');
  while (!text.empty()) {
    std::string_view line = Cut(text, '\n');
    csv.frames.push_back(static_cast<std::size_t>(Number(Cut(line, ','))));
    std::vector<double>& row = csv.rows.emplace_back();
    while (!line.empty()) row.push_back(Number(Cut(line, ',')));
  }
  return csv;
}

}  // namespace arap::cli
