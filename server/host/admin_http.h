// AdminHttp: the page for operators and load balancers, plain HTTP.
//   GET /healthz  200 while the process runs
//   GET /readyz   200, 404 while draining (which haproxy takes for "no new sessions"), else 503
//   GET /metrics  the text format of Prometheus
// healthz and readyz answer {"status":"…","why":"…"}. It knows no callers: it belongs on loopback
// or on a network of its own. It tells nothing of what is in sessions.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "arap/base/result.h"
#include "server/host/readiness.h"

namespace arap::host {

struct AdminPages {
  std::function<Verdict()> readiness;
  std::function<std::string()> metrics;
};

// Host and port of "127.0.0.1:9464", "[::1]:9464" or "name:9464". kInvalidOption.
struct AdminAddress {
  std::string host;
  int port = 0;  // 0: any free one
};
Result<AdminAddress> ParseAdminAddress(const std::string& address);

class AdminHttp {
 public:
  // Serves when it returns, in threads of its own; what the pages use outlives it. kInvalidOption,
  // and kAlreadyExists for an address that cannot be had.
  static Result<std::unique_ptr<AdminHttp>> Start(const std::string& address, AdminPages pages);
  // Stops.
  ~AdminHttp();
  AdminHttp(const AdminHttp&) = delete;
  AdminHttp& operator=(const AdminHttp&) = delete;

  // With the port that was bound.
  const std::string& address() const;

 private:
  class Impl;
  explicit AdminHttp(std::unique_ptr<Impl> impl);
  const std::unique_ptr<Impl> impl_;
};

}  // namespace arap::host
