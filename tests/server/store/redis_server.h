// RedisServer: a real Redis for one test, on a free port, with a directory of its own.
#pragma once

#include <string>
#include <vector>

#include "tests/server/store/local_server.h"
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

  // "redis://127.0.0.1:PORT", with the password if there is one.
  std::string Url() const;

  int port() const { return server_.port(); }

  void Kill() { server_.Kill(); }
  void Restart() { server_.Restart(); }  // with what is on disk
  void Freeze() { server_.Freeze(); }
  void Thaw() { server_.Thaw(); }

 private:
  std::vector<std::string> CommandLine(int port) const;

  TempDir dir_;
  const RedisSetup setup_;
  LocalServer server_;  // last: it uses all of the above
};

}  // namespace arap::testing
