// LocalServer: the process of a server that is not ours, for one test, on a free port of this machine.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace arap::testing {

// One that nobody listens on just now.
int FreePort();

// What tests need of Redis and of a server of objects alike. Ends with the object.
class LocalServer {
 public:
  using Words = std::function<std::vector<std::string>(int port)>;

  // `words(port)` is the command line, `answers(port)` says whether it is there. Of what it says,
  // standard output is dropped, and errors too when it is `silent`. Throws when it does not start.
  LocalServer(Words words, std::function<bool(int port)> answers, bool silent = false);
  ~LocalServer() { Kill(); }
  LocalServer(const LocalServer&) = delete;
  LocalServer& operator=(const LocalServer&) = delete;

  int port() const { return port_; }

  void Kill();     // SIGKILL, and waits for the end
  void Restart();  // on the same port
  void Freeze();   // SIGSTOP
  void Thaw();     // SIGCONT

 private:
  bool Start();

  const Words words_;
  const std::function<bool(int port)> answers_;
  const bool silent_;
  int port_ = 0;
  pid_t process_ = -1;
};

}  // namespace arap::testing
