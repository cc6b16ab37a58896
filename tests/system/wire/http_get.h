// HttpGet: a page of the admin server. Apart, because the HTTP library brings a macro _res that
// Eigen cannot live with.
#pragma once

#include <string>

namespace arap::wire {

struct Page {
  int status = 0;  // 0: nobody answers
  std::string body;
};

// `address` is host:port.
Page HttpGet(const std::string& address, const std::string& path);

}  // namespace arap::wire
