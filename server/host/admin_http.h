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
#include <thread>
#include <vector>

#include "arap/base/result.h"
#include "server/host/listen.h"
#include "server/host/readiness.h"

namespace arap::host {

struct AdminPages {
  std::function<Verdict()> readiness;
  std::function<std::string()> metrics;
};

// One thread that never waits for a client: a request has two seconds from its connection to the
// last byte of its answer, and when there are too many clients the one that has been there longest
// goes. So whoever asks and listens is answered, however many do not.
class AdminHttp {
 public:
  // Serves when it returns; what the pages use outlives it. Faults as Listening::Open.
  static Result<std::unique_ptr<AdminHttp>> Start(const std::string& address, AdminPages pages);
  // Stops.
  ~AdminHttp();
  AdminHttp(const AdminHttp&) = delete;
  AdminHttp& operator=(const AdminHttp&) = delete;

  // With the port that was bound.
  const std::string& address() const { return listening_.address(); }

 private:
  struct Client;

  AdminHttp(Listening listening, AdminPages pages);
  void Run();
  void Accept(const Descriptor& listener, std::vector<Client>& clients);
  // False when the client is done or to be dropped.
  bool Serve(Client& client) const;
  std::string AnswerTo(const std::string& request) const;

  const Listening listening_;
  const AdminPages pages_;
  const Descriptor wake_;  // readable when it is to stop
  std::thread thread_;
};

}  // namespace arap::host
