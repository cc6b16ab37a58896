#include "tests/system/fault/harm.h"

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/bounded.h"

namespace arap::fault {
namespace {

// Those that wait in the queue of a server that does not accept them too.
std::size_t ConnectionsTo(const std::string& path) {
  std::ifstream sockets("/proc/net/unix");
  std::size_t count = 0;
  for (std::string line; std::getline(sockets, line);) {
    if (line.ends_with(' ' + path)) ++count;
  }
  return count;
}

}  // namespace

const char* NameOf(Harm harm) {
  switch (harm) {
    case Harm::kKill:
      return "Kill";
    case Harm::kDrain:
      return "Drain";
    case Harm::kFreeze:
      return "Freeze";
  }
  return "";
}

std::size_t Rounds() {
  const char* text =
      std::getenv("ARAP_RESUME_ROUNDS");  // NOLINT(concurrency-mt-unsafe): nobody sets it
  return text == nullptr ? 2 : std::strtoull(text, nullptr, 10);
}

bool Do(Harm harm, ServerProcess& server, const std::function<void()>& meanwhile) {
  switch (harm) {
    case Harm::kKill:
      server.Kill();
      if (meanwhile) meanwhile();
      return server.Start();
    case Harm::kDrain:
      server.Signal(SIGTERM);
      if (meanwhile) meanwhile();
      EXPECT_EQ(server.Wait(testing::kLongest), 0);
      return server.Start();
    case Harm::kFreeze:
      break;
  }
  const std::string path = server.folder() / "socket";
  server.Signal(SIGSTOP);
  const std::size_t before = ConnectionsTo(path);
  EXPECT_GT(before, 0u) << path;
  if (meanwhile) meanwhile();
  const auto noticed =
      testing::Await("the frozen server is noticed", [&] { return ConnectionsTo(path) > before; });
  EXPECT_TRUE(noticed);
  server.Signal(SIGCONT);
  return static_cast<bool>(noticed);
}

}  // namespace arap::fault
