// Requests to an object store are signed as Amazon's specification (AWS Signature Version 4) says,
// reckoned here once more from what has arrived.
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <httplib.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>

#include "core/base/names.h"
#include "core/token/digest.h"
#include "server/store/blobs/s3_client.h"

namespace arap::store {
namespace {

std::string Hmac(const std::string& key, const std::string& text) {
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned size = 0;
  HMAC(EVP_sha256(), key.data(), static_cast<int>(key.size()),
       reinterpret_cast<const unsigned char*>(text.data()), text.size(), digest, &size);
  return {reinterpret_cast<const char*>(digest), size};
}

std::vector<std::string> Split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

// What stands after "NAME=" up to a comma.
std::string Part(const std::string& authorization, const std::string& name) {
  const std::size_t start = authorization.find(name + "=") + name.size() + 1;
  return authorization.substr(start, authorization.find(',', start) - start);
}

std::string SignatureOf(const httplib::Request& request, const std::string& secret) {
  const std::string authorization = request.get_header_value("Authorization");
  const std::string names = Part(authorization, "SignedHeaders");
  // ID/DATE/REGION/SERVICE/aws4_request
  const std::string credential = Part(authorization, "Credential");
  const std::string scope = credential.substr(credential.find('/') + 1);
  const std::size_t query = request.target.find('?');
  std::string canonical = request.method + "\n" + request.target.substr(0, query) + "\n" +
                          (query == std::string::npos ? "" : request.target.substr(query + 1)) +
                          "\n";
  for (const std::string& name : Split(names, ';')) {
    canonical += name + ":" + request.get_header_value(name.c_str()) + "\n";
  }
  canonical += "\n" + names + "\n" + request.get_header_value("x-amz-content-sha256");
  const std::string text = "AWS4-HMAC-SHA256\n" + request.get_header_value("x-amz-date") + "\n" +
                           scope + "\n" + *Sha256Hex(canonical);
  std::string key = "AWS4" + secret;
  for (const std::string& part : Split(scope, '/')) key = Hmac(key, part);
  const std::string signature = Hmac(key, text);
  return Hex({reinterpret_cast<const unsigned char*>(signature.data()), signature.size()});
}

TEST(S3SignatureTest, IsThatOfTheSpecification) {
  std::vector<httplib::Request> requests;
  httplib::Server server;
  server.set_keep_alive_max_count(1);
  const auto take = [&requests](const httplib::Request& request, httplib::Response&) {
    requests.push_back(request);
  };
  server.Get(".*", take);
  server.Put(".*", take);
  server.Delete(".*", take);
  const int port = server.bind_to_any_port("127.0.0.1");
  std::thread thread([&server] { server.listen_after_bind(); });

  S3Options options;
  options.bucket = "arapd";
  options.prefix = "some/where/";
  options.endpoint = "http://127.0.0.1:" + std::to_string(port);
  options.region = "eu-central-1";
  options.key_id = "ID";
  options.secret = "s3cret/+=";
  options.session_token = "token/of+session=";
  S3Client client(options);
  EXPECT_TRUE(client.Put("blobs/a", "bytes", *Sha256Hex("bytes")));
  EXPECT_TRUE(client.Put("store-id", "bytes", *Sha256Hex("bytes"), true));
  EXPECT_TRUE(client.Get("blobs/a"));
  EXPECT_TRUE(client.Copy("blobs/a", "aside/a"));
  EXPECT_TRUE(client.Delete("blobs/a"));
  EXPECT_TRUE(client.List("blobs/"));
  server.stop();
  thread.join();

  ASSERT_EQ(requests.size(), 6u);
  for (const httplib::Request& request : requests) {
    const std::string authorization = request.get_header_value("Authorization");
    EXPECT_EQ(authorization.find("AWS4-HMAC-SHA256 Credential=ID/"), 0u) << authorization;
    EXPECT_NE(authorization.find("/eu-central-1/s3/aws4_request"), std::string::npos);
    EXPECT_EQ(Part(authorization, "Signature"), SignatureOf(request, options.secret))
        << request.method << " " << request.target << "\n"
        << authorization;
    EXPECT_NE(SignatureOf(request, "other"), SignatureOf(request, options.secret));
    for (const char* name :
         {"host", "x-amz-content-sha256", "x-amz-date", "x-amz-security-token"}) {
      EXPECT_NE(
          (";" + Part(authorization, "SignedHeaders") + ";").find(std::string(";") + name + ";"),
          std::string::npos)
          << name;
    }
    EXPECT_EQ(request.get_header_value("x-amz-content-sha256"), *Sha256Hex(request.body));
    for (const auto& [name, value] : request.headers) {
      EXPECT_EQ(value.find("s3cret"), std::string::npos) << name;
    }
  }
  EXPECT_EQ(requests[0].target, "/arapd/some/where/blobs/a");
  EXPECT_EQ(requests[1].get_header_value("If-None-Match"), "*");
  EXPECT_EQ(requests[3].get_header_value("x-amz-copy-source"), "/arapd/some/where/blobs/a");
}

}  // namespace
}  // namespace arap::store
