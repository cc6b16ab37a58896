#include "tests/server/store/s3_server.h"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <stdexcept>
#include <vector>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/server/store/redis_server.h"

namespace arap::testing {

bool S3Server::Installed() {
  return std::filesystem::exists(ARAP_NODE) && std::filesystem::exists(ARAP_S3RVER);
}

S3Server::S3Server() {
  // Somebody may take the port before it does.
  for (int attempt = 0; attempt < 20; ++attempt) {
    port_ = FreePort();
    if (Start()) return;
  }
  throw std::runtime_error("s3rver does not start");
}

S3Server::~S3Server() { Kill(); }

store::S3Options S3Server::Options() const {
  store::S3Options options;
  options.bucket = "arapd";
  options.prefix = "some/where/";
  options.endpoint = "http://127.0.0.1:" + std::to_string(port_);
  options.key_id = "S3RVER";
  options.secret = "S3RVER";
  return options;
}

bool S3Server::Start() {
  // It makes the tokens of its pages with a cipher that OpenSSL 3 has there.
  std::vector<std::string> words{ARAP_NODE,
                                 "--openssl-legacy-provider",
                                 ARAP_S3RVER,
                                 "--silent",
                                 "--directory",
                                 dir_.path(),
                                 "--address",
                                 "127.0.0.1",
                                 "--port",
                                 std::to_string(port_),
                                 "--no-vhost-buckets",
                                 "--configure-bucket",
                                 "arapd"};
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t quiet{};
  posix_spawn_file_actions_init(&quiet);
  for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) {
    posix_spawn_file_actions_addopen(&quiet, stream, "/dev/null", O_WRONLY, 0);
  }
  const int error = posix_spawn(&process_, ARAP_NODE, &quiet, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&quiet);
  if (error != 0) return false;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (std::chrono::steady_clock::now() < deadline) {
    if (waitpid(process_, nullptr, WNOHANG) == process_) {
      process_ = -1;
      return false;
    }
    if (store::S3Client(Options()).List("").has_value()) return true;
    poll(nullptr, 0, 20);
  }
  Kill();
  return false;
}

void S3Server::Kill() {
  if (process_ < 0) return;
  kill(process_, SIGKILL);
  while (waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
  }
  process_ = -1;
}

void S3Server::Restart() {
  if (!Start()) throw std::runtime_error("s3rver does not start again");
}

}  // namespace arap::testing
