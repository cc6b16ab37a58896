#include "tests/server/store/s3_server.h"

#include <filesystem>
#include <string>
#include <vector>

namespace arap::testing {
namespace {

store::S3Options At(int port) {
  store::S3Options options;
  options.bucket = "arapd";
  options.prefix = "some/where/";
  options.endpoint = "http://127.0.0.1:" + std::to_string(port);
  options.key_id = "S3RVER";
  options.secret = "S3RVER";
  return options;
}

// It makes the tokens of its pages with a cipher that OpenSSL 3 has only there.
std::vector<std::string> CommandLine(const std::string& folder, int port) {
  return {ARAP_NODE,
          "--openssl-legacy-provider",
          ARAP_S3RVER,
          "--silent",
          "--directory",
          folder,
          "--address",
          "127.0.0.1",
          "--port",
          std::to_string(port),
          "--no-vhost-buckets",
          "--configure-bucket",
          "arapd"};
}

}  // namespace

bool S3Server::Installed() {
  return std::filesystem::exists(ARAP_NODE) && std::filesystem::exists(ARAP_S3RVER);
}

S3Server::S3Server()
    : server_([this](int port) { return CommandLine(dir_.path(), port); },
              [](int port) { return store::S3Client(At(port)).List("").has_value(); }, true) {}

store::S3Options S3Server::Options() const { return At(server_.port()); }

}  // namespace arap::testing
