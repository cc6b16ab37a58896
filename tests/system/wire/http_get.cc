#include "tests/system/wire/http_get.h"

#include <httplib.h>

namespace arap::wire {

Page HttpGet(const std::string& address, const std::string& path) {
  httplib::Client client("http://" + address);
  const auto answer = client.Get(path.c_str());
  if (!answer) return {};
  return {answer->status, answer->body};
}

}  // namespace arap::wire
