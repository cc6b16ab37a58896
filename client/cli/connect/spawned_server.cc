#include "client/cli/connect/spawned_server.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/try.h"

// The header of glibc 2.36 forgets that C++ may include it.
extern "C" {
#include <sys/pidfd.h>
}

namespace arap::cli {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kStartTimeout{30'000};
constexpr milliseconds kStopTimeout{15'000};
// A socket's path may have 107 bytes; a longer directory for temporary files is not used.
constexpr std::size_t kLongestDirectory = 80;

auto SystemFault(std::string_view what) {
  return Fail(FaultKind::kInternal,
              fmt::format("{}: {}.", what, std::generic_category().message(errno)));
}

std::string FindServer() {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::string beside = (self.parent_path() / "arapd").string();
  if (!error && access(beside.c_str(), X_OK) == 0) return beside;
  return "arapd";  // execvp searches PATH
}

// The child's side: only calls that are safe between fork and exec.
[[noreturn]] void BecomeServer(char* const* arguments, int output, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(0);  // the parent died before the line above
  dup2(output, STDOUT_FILENO);
  execvp(arguments[0], arguments);
  constexpr std::string_view kMessage = "arapctl: cannot run arapd\n";
  [[maybe_unused]] const auto written = write(STDERR_FILENO, kMessage.data(), kMessage.size());
  _exit(127);
}

}  // namespace

Result<SpawnedServer> SpawnedServer::Start() {
  SpawnedServer server;
  std::error_code error;
  std::string base = std::filesystem::temp_directory_path(error).string();
  if (error || base.size() > kLongestDirectory) base = "/tmp";
  std::string pattern = base + "/arapctl-XXXXXX";
  if (mkdtemp(pattern.data()) == nullptr) return SystemFault("Cannot make " + pattern);
  server.directory_ = pattern;
  CHECK_OK(server.Launch());
  CHECK_OK(server.AwaitListening());
  return server;
}

Status SpawnedServer::Launch() {
  std::string program = FindServer();
  std::string listen = "unix:" + directory_ + "/arapd.sock";
  std::string listen_flag = "--listen", level_flag = "--log-level", level = "warn";
  std::string store_flag = "--store", store = "memory", no_admin_flag = "--no-admin";
  const std::array<char*, 9> arguments{program.data(),    listen_flag.data(),   listen.data(),
                                       level_flag.data(), level.data(),         store_flag.data(),
                                       store.data(),      no_admin_flag.data(), nullptr};
  std::array<int, 2> pipe_ends{};
  if (pipe2(pipe_ends.data(), O_CLOEXEC) != 0) return SystemFault("Cannot make a pipe");
  output_ = pipe_ends[0];
  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid == 0) BecomeServer(arguments.data(), pipe_ends[1], parent);
  close(pipe_ends[1]);
  if (pid < 0) return SystemFault("Cannot start arapd");
  pid_ = pid;
  return {};
}

Status SpawnedServer::AwaitListening() {
  constexpr std::string_view kLine = "arapd listening on ";
  const auto deadline = steady_clock::now() + kStartTimeout;
  std::string text;
  std::array<char, 512> buffer{};
  for (;;) {
    if (const std::size_t at = text.find(kLine); at != std::string::npos) {
      if (const std::size_t end = text.find('\n', at); end != std::string::npos) {
        address_ = text.substr(at + kLine.size(), end - at - kLine.size());
        return {};
      }
    }
    const auto left = std::chrono::duration_cast<milliseconds>(deadline - steady_clock::now());
    pollfd wait{output_, POLLIN, 0};
    const int ready = left.count() > 0 ? poll(&wait, 1, static_cast<int>(left.count())) : 0;
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0)
      return Fail(FaultKind::kDeadlineExceeded,
                  fmt::format("arapd did not listen within {} s.", kStartTimeout.count() / 1000));
    const ssize_t count = read(output_, buffer.data(), buffer.size());
    if (count <= 0) return Fail(FaultKind::kInternal, "arapd ended before it was listening.");
    text.append(buffer.data(), static_cast<std::size_t>(count));
  }
}

void SpawnedServer::Stop() {
  if (pid_ > 0) {
    kill(pid_, SIGTERM);
    // A server that does not go is killed.
    if (const int handle = pidfd_open(pid_, 0); handle >= 0) {
      pollfd wait{handle, POLLIN, 0};
      if (poll(&wait, 1, static_cast<int>(kStopTimeout.count())) <= 0) kill(pid_, SIGKILL);
      close(handle);
    }
    while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
  }
  if (output_ >= 0) close(std::exchange(output_, -1));
  if (!directory_.empty()) {
    std::error_code ignored;
    std::filesystem::remove_all(directory_, ignored);
    directory_.clear();
  }
}

SpawnedServer::SpawnedServer(SpawnedServer&& other) noexcept { *this = std::move(other); }

SpawnedServer& SpawnedServer::operator=(SpawnedServer&& other) noexcept {
  std::swap(directory_, other.directory_);
  std::swap(address_, other.address_);
  std::swap(pid_, other.pid_);
  std::swap(output_, other.output_);
  return *this;
}

SpawnedServer::~SpawnedServer() { Stop(); }

}  // namespace arap::cli
