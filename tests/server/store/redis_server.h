// RedisServer: a real Redis for one test, on a free port, with a directory of its own.
#pragma once

#include <string>

#include <sys/types.h>

#include "tests/server/store/temp_dir.h"

namespace arap::testing {

// Writes every change to disk before it answers. Ends with the object.
class RedisServer {
 public:
  explicit RedisServer(std::string password = "");
  ~RedisServer();
  RedisServer(const RedisServer&) = delete;
  RedisServer& operator=(const RedisServer&) = delete;

  // "redis://127.0.0.1:PORT", with the password if there is one.
  std::string Url() const;

  int port() const { return port_; }

  void Kill();     // SIGKILL, and waits for the end
  void Restart();  // on the same port, with what is on disk
  void Freeze();   // SIGSTOP
  void Thaw();     // SIGCONT

 private:
  bool Start();
  bool Answers() const;

  TempDir dir_;
  std::string password_;
  int port_ = 0;
  pid_t process_ = -1;
};

}  // namespace arap::testing
