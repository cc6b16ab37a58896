#include "tests/system/fault/haproxy.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/system/fault/client.h"

namespace arap::fault {
namespace {

std::string ReadFile(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

// False with a failure of the test when `from` is not there once: the file has changed.
bool Replace(std::string& text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) {
    ADD_FAILURE() << "docker/haproxy.cfg has no " << from;
    return false;
  }
  text.replace(at, from.size(), to);
  return true;
}

std::string PortOf(const std::string& address) { return address.substr(address.rfind(':') + 1); }

// As haproxy writes it: "unix@PATH".
std::string Written(std::string address) {
  if (address.starts_with("unix:")) address.replace(0, 5, "unix@");
  return address;
}

std::string Servers(const std::vector<Backend>& backends) {
  std::string lines;
  for (const Backend& backend : backends) {
    const std::string name(1, static_cast<char>('a' + (&backend - backends.data())));
    lines += (lines.empty() ? "server " : "\n    server ") + name + " " + Written(backend.address) +
             " check addr 127.0.0.1 port " + PortOf(backend.admin);
  }
  return lines;
}

}  // namespace

bool Haproxy::Start(const std::vector<Backend>& backends) {
  std::string text = ReadFile(HAPROXY_CFG);
  if (!Replace(text, "bind :50051", "bind unix@" + folder_ / "socket") ||
      !Replace(text, "server a a:50051 check port 9464", Servers(backends)) ||
      !Replace(text, "server b b:50051 check port 9464", "")) {
    return false;
  }
  std::ofstream(folder_ / "cfg") << text;
  // -db: in the foreground.
  if (!Launch({HAPROXY, "-db", "-f", folder_ / "cfg"}, folder_ / "stderr")) return false;
  if (Eventually([&] { return std::filesystem::exists(folder_ / "socket"); })) return true;
  ADD_FAILURE() << "haproxy does not listen:\n" << Log();
  return false;
}

std::string Haproxy::Log() const { return ReadFile(folder_ / "stderr"); }

}  // namespace arap::fault
