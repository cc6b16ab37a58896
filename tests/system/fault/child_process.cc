#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/system/fault/server_process.h"

// The header of glibc 2.36 forgets that C++ may include it.
extern "C" {
#include <sys/pidfd.h>
}

namespace arap::fault {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

int MillisecondsUntil(steady_clock::time_point deadline) {
  const auto left = std::chrono::ceil<milliseconds>(deadline - steady_clock::now()).count();
  return left > 0 ? static_cast<int>(left) : 0;
}

// Whether `descriptor` has something to read, or its end, before the deadline.
bool Await(int descriptor, steady_clock::time_point deadline) {
  pollfd wait{descriptor, POLLIN, 0};
  for (;;) {
    const int ready = poll(&wait, 1, MillisecondsUntil(deadline));
    if (ready > 0) return true;
    if (ready == 0 || errno != EINTR) return false;
  }
}

}  // namespace

TempFolder::TempFolder() {
  // The path of a unix socket may have 107 bytes.
  std::string pattern = "/tmp/arap-fault-XXXXXX";
  if (mkdtemp(pattern.data()) == nullptr) ADD_FAILURE() << "cannot make " << pattern;
  path_ = pattern;
}

TempFolder::~TempFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

ChildProcess::~ChildProcess() { Kill(); }

bool ChildProcess::Launch(const std::vector<std::string>& words, const std::string& error_path) {
  EXPECT_FALSE(running());
  // No fork in a process full of gRPC's threads; setpriv ties the child's life to ours.
  std::vector<std::string> all{"/usr/bin/setpriv", "--pdeathsig", "KILL"};
  all.insert(all.end(), words.begin(), words.end());
  std::vector<char*> argv;
  argv.reserve(all.size() + 1);
  for (std::string& word : all) argv.push_back(word.data());
  argv.push_back(nullptr);

  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    ADD_FAILURE() << "cannot make a pipe";
    return false;
  }
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, error_path.c_str(),
                                   O_WRONLY | O_CREAT | O_APPEND, 0600);
  const int error = posix_spawn(&pid_, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  output_ = ends[0];
  text_.clear();
  if (error != 0) {
    pid_ = -1;
    Close();
    ADD_FAILURE() << "cannot run " << words.front();
    return false;
  }
  handle_ = pidfd_open(pid_, 0);
  EXPECT_GE(handle_, 0);
  return true;
}

std::optional<std::string> ChildProcess::ReadLine(const std::string& prefix, milliseconds timeout) {
  const auto deadline = steady_clock::now() + timeout;
  std::array<char, 4096> buffer{};
  for (;;) {
    for (std::size_t end = 0; (end = text_.find('\n')) != std::string::npos;) {
      const std::string line = text_.substr(0, end);
      text_.erase(0, end + 1);
      if (line.compare(0, prefix.size(), prefix) == 0) return line.substr(prefix.size());
    }
    if (output_ < 0 || !Await(output_, deadline)) return std::nullopt;
    const ssize_t count = read(output_, buffer.data(), buffer.size());
    if (count == 0 || (count < 0 && errno != EINTR)) return std::nullopt;
    if (count > 0) text_.append(buffer.data(), static_cast<std::size_t>(count));
  }
}

void ChildProcess::Signal(int signal) const {
  ASSERT_TRUE(running());
  EXPECT_EQ(kill(pid_, signal), 0);
  if (signal != SIGSTOP) return;
  // kill returns before all of its threads have stopped.
  siginfo_t info{};
  while (waitid(P_PID, static_cast<id_t>(pid_), &info, WSTOPPED | WEXITED | WNOWAIT) < 0 &&
         errno == EINTR) {
  }
}

std::optional<int> ChildProcess::Wait(milliseconds timeout) {
  if (!running() || !Await(handle_, steady_clock::now() + timeout)) return std::nullopt;
  int status = 0;
  while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
  pid_ = -1;
  Close();
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

void ChildProcess::Kill() {
  if (!running()) return;
  kill(pid_, SIGKILL);
  while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
  }
  pid_ = -1;
  Close();
}

void ChildProcess::Close() {
  if (handle_ >= 0) close(std::exchange(handle_, -1));
  if (output_ >= 0) close(std::exchange(output_, -1));
}

std::size_t ChildProcess::ResidentBytes() const {
  std::ifstream status("/proc/" + std::to_string(pid_) + "/status");
  std::string word;
  std::size_t kilobytes = 0;
  while (status >> word) {
    if (word == "VmRSS:") status >> kilobytes;
  }
  EXPECT_GT(kilobytes, 0u) << "the process is gone";
  return kilobytes * 1024;
}

std::size_t ChildProcess::Descriptors() const {
  std::error_code error;
  const std::filesystem::directory_iterator all("/proc/" + std::to_string(pid_) + "/fd", error);
  EXPECT_FALSE(error) << "the process is gone";
  return static_cast<std::size_t>(std::distance(begin(all), std::filesystem::directory_iterator{}));
}

}  // namespace arap::fault
