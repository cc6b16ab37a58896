// Haproxy: the real haproxy with docker/haproxy.cfg, its addresses replaced.
#pragma once

#include <string>
#include <vector>

#include "tests/system/fault/server_process.h"

namespace arap::fault {

// Where one of its servers is reached.
struct Backend {
  std::string address;  // "127.0.0.1:1234", "unix:PATH"
  std::string admin;    // "127.0.0.1:1234"
};

// Listens on a socket in its own folder. The servers need not run.
class Haproxy : public ChildProcess {
 public:
  // False with a failure of the test when it does not start.
  // In place of the two servers of the file come these.
  bool Start(const std::vector<Backend>& backends);

  // For clients: "unix:PATH".
  std::string address() const { return "unix:" + folder_ / "socket"; }
  // What it says on standard error.
  std::string Log() const;

 private:
  TempFolder folder_;
};

}  // namespace arap::fault
