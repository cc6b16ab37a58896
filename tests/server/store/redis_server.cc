#include "tests/server/store/redis_server.h"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <stdexcept>
#include <utility>
#include <vector>

#include <arpa/inet.h>
#include <fcntl.h>
#include <hiredis/hiredis.h>
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

RedisServer::RedisServer(RedisSetup setup) : setup_(std::move(setup)) {
  // Somebody may take the port before Redis does.
  for (int attempt = 0; attempt < 20; ++attempt) {
    port_ = FreePort();
    if (Start()) return;
  }
  throw std::runtime_error("redis-server does not start");
}

RedisServer::~RedisServer() { Kill(); }

std::string RedisServer::Url() const {
  const std::string user = setup_.password.empty() ? "" : ":" + setup_.password + "@";
  return "redis://" + user + "127.0.0.1:" + std::to_string(port_);
}

bool RedisServer::Answers() const {
  const timeval limit{1, 0};
  redisContext* context = redisConnectWithTimeout("127.0.0.1", port_, limit);
  bool good = false;
  if (context != nullptr && context->err == 0) {
    redisSetTimeout(context, limit);
    // Redis that wants a password or still loads answers with an error: only NOAUTH is ready.
    auto* reply = static_cast<redisReply*>(redisCommand(context, "PING"));
    good = reply != nullptr && (reply->type != REDIS_REPLY_ERROR ||
                                std::string(reply->str, reply->len).starts_with("NOAUTH"));
    if (reply != nullptr) freeReplyObject(reply);
  }
  if (context != nullptr) redisFree(context);
  return good;
}

std::vector<std::string> RedisServer::CommandLine() const {
  if (!setup_.sentinel.empty()) {
    // It writes into the file what it has found out.
    const std::string file = dir_ / "sentinel.conf";
    Spill(file, "port " + std::to_string(port_) + "\nbind 127.0.0.1\ndir " + dir_.path() +
                    "\nlogfile " + (dir_ / "log") + "\n" + setup_.sentinel);
    return {ARAP_REDIS_SERVER, file, "--sentinel"};
  }
  std::vector<std::string> words{ARAP_REDIS_SERVER,
                                 "--bind",
                                 "127.0.0.1",
                                 "--port",
                                 std::to_string(port_),
                                 "--dir",
                                 dir_.path(),
                                 "--appendonly",
                                 "yes",
                                 "--appendfsync",
                                 "always",
                                 "--save",
                                 "",
                                 "--logfile",
                                 dir_ / "log",
                                 "--daemonize",
                                 "no"};
  if (!setup_.password.empty()) words.insert(words.end(), {"--requirepass", setup_.password});
  words.insert(words.end(), setup_.words.begin(), setup_.words.end());
  return words;
}

bool RedisServer::Start() {
  std::vector<std::string> words = CommandLine();
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t quiet{};
  posix_spawn_file_actions_init(&quiet);
  posix_spawn_file_actions_addopen(&quiet, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  const int error =
      posix_spawn(&process_, ARAP_REDIS_SERVER, &quiet, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&quiet);
  if (error != 0) return false;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (std::chrono::steady_clock::now() < deadline) {
    if (waitpid(process_, nullptr, WNOHANG) == process_) {
      process_ = -1;
      return false;
    }
    if (Answers()) return true;
    poll(nullptr, 0, 5);
  }
  Kill();
  return false;
}

void RedisServer::Kill() {
  if (process_ < 0) return;
  kill(process_, SIGKILL);
  while (waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
  }
  process_ = -1;
}

void RedisServer::Restart() {
  if (!Start()) throw std::runtime_error("redis-server does not start again");
}

void RedisServer::Freeze() {
  kill(process_, SIGSTOP);
  int status = 0;
  waitpid(process_, &status, WUNTRACED);
}

void RedisServer::Thaw() { kill(process_, SIGCONT); }

}  // namespace arap::testing
