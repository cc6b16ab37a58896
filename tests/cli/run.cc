#include "tests/cli/run.h"

#include <array>
#include <cerrno>
#include <thread>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/files/text_file.h"

namespace arap::cli {
namespace {

std::string Drain(int descriptor) {
  std::string text;
  std::array<char, 4096> buffer{};
  ssize_t count = 0;
  while ((count = read(descriptor, buffer.data(), buffer.size())) > 0 || errno == EINTR) {
    if (count > 0) text.append(buffer.data(), static_cast<std::size_t>(count));
    errno = 0;
    if (count == 0) break;
  }
  close(descriptor);
  return text;
}

}  // namespace

Outcome Arapctl(const std::vector<std::string>& arguments) {
  std::vector<std::string> words{ARAPCTL};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  std::array<int, 2> out{}, err{};
  EXPECT_EQ(pipe2(out.data(), O_CLOEXEC), 0);
  EXPECT_EQ(pipe2(err.data(), O_CLOEXEC), 0);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, out[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, err[1], STDERR_FILENO);
  pid_t pid = -1;
  EXPECT_EQ(posix_spawn(&pid, argv[0], &actions, nullptr, argv.data(), environ), 0);
  posix_spawn_file_actions_destroy(&actions);
  close(out[1]);
  close(err[1]);

  Outcome outcome;
  // Both at once: a full pipe would stop the program.
  std::thread other([&] { outcome.err = Drain(err[0]); });
  outcome.out = Drain(out[0]);
  other.join();
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

}  // namespace arap::cli
