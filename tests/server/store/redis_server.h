// RedisServer: a real Redis for one test, on a free port, with a directory of its own.
#pragma once

#include <string>
#include <vector>

#include <sys/types.h>

#include "tests/server/store/temp_dir.h"

namespace arap::testing {

struct RedisSetup {
  std::string password;            // of the default user
  std::vector<std::string> words;  // more of the command line
  std::string sentinel;            // makes a sentinel of it: the lines of its configuration
};

// Writes every change to disk before it answers. Ends with the object.
class RedisServer {
 public:
  explicit RedisServer(const std::string& password = "")
      : RedisServer(RedisSetup{password, {}, {}}) {}
  explicit RedisServer(RedisSetup setup);
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
  std::vector<std::string> CommandLine() const;
  bool Answers() const;

  TempDir dir_;
  const RedisSetup setup_;
  int port_ = 0;
  pid_t process_ = -1;
};

// One that nobody listens on just now.
int FreePort();

}  // namespace arap::testing
