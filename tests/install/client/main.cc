// Connects nowhere: the library is linked, and says so in its own words.
#include <chrono>
#include <cstdio>

#include <arap/client/client.h>

int main() {
  const auto client = arap::client::Client::Connect("unix:/nonexistent/arapd.sock");
  const auto info = client.GetServerInfo(
      {.timeout = std::chrono::seconds(30), .retry_within = std::chrono::milliseconds(0)});
  if (info || info.error().kind != arap::FaultKind::kDraining) return 1;
  std::puts(info.error().message.c_str());
  return 0;
}
