#include "tests/server/store/local_server.h"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <stdexcept>
#include <utility>

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace arap::testing {

int FreePort() {
  const int socket_fd = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  auto* any = reinterpret_cast<sockaddr*>(&address);
  const bool good = bind(socket_fd, any, size) == 0 && getsockname(socket_fd, any, &size) == 0;
  close(socket_fd);
  return good ? ntohs(address.sin_port) : 0;
}

LocalServer::LocalServer(Words words, std::function<bool(int port)> answers, bool silent)
    : words_(std::move(words)), answers_(std::move(answers)), silent_(silent) {
  // Somebody may take the port before it does.
  for (int attempt = 0; attempt < 20; ++attempt) {
    port_ = FreePort();
    if (Start()) return;
  }
  throw std::runtime_error(words_(port_).front() + " does not start");
}

bool LocalServer::Start() {
  std::vector<std::string> words = words_(port_);
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t quiet{};
  posix_spawn_file_actions_init(&quiet);
  posix_spawn_file_actions_addopen(&quiet, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  if (silent_) posix_spawn_file_actions_addopen(&quiet, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  const int error =
      posix_spawn(&process_, arguments.front(), &quiet, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&quiet);
  if (error != 0) return false;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (std::chrono::steady_clock::now() < deadline) {
    if (waitpid(process_, nullptr, WNOHANG) == process_) {
      process_ = -1;
      return false;
    }
    if (answers_(port_)) return true;
    poll(nullptr, 0, 5);
  }
  Kill();
  return false;
}

void LocalServer::Kill() {
  if (process_ < 0) return;
  kill(process_, SIGKILL);
  while (waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
  }
  process_ = -1;
}

void LocalServer::Restart() {
  if (!Start()) throw std::runtime_error(words_(port_).front() + " does not start again");
}

void LocalServer::Freeze() {
  kill(process_, SIGSTOP);
  int status = 0;
  waitpid(process_, &status, WUNTRACED);
}

void LocalServer::Thaw() { kill(process_, SIGCONT); }

}  // namespace arap::testing
