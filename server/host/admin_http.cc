#include "server/host/admin_http.h"

#include <charconv>
#include <future>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <httplib.h>
#include <nlohmann/json.hpp>
#include <sys/socket.h>

#include "core/base/try.h"

namespace arap::host {
namespace {

constexpr std::size_t kThreads = 4;
constexpr int kPatienceSeconds = 5;
constexpr std::size_t kLongestRequest = 4'096;  // bytes of a body; no page takes one
constexpr int kMaxPort = 65'535;

Fault Bad(const std::string& address, const char* why) {
  Fault fault = Fault(FaultKind::kInvalidOption,
                      fmt::format("Cannot serve the admin page on {}: {}.", address, why))
                    .Field("admin");
  return fault.Detail("address", address);
}

// The port is ours alone: the library's own default lets another process share it.
void OwnThePort(socket_t socket) {
  const int yes = 1;
  setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
}

int HttpStatus(Verdict::State state) {
  constexpr int kOk = 200, kNotFound = 404, kUnavailable = 503;
  if (state == Verdict::State::kReady) return kOk;
  return state == Verdict::State::kDraining ? kNotFound : kUnavailable;
}

void Answer(const Verdict& verdict, httplib::Response& response) {
  nlohmann::json body{{"status", StateName(verdict.state)}};
  if (!verdict.why.empty()) body["why"] = verdict.why;
  response.set_content(body.dump() + "\n", "application/json");
}

}  // namespace

Result<AdminAddress> ParseAdminAddress(const std::string& address) {
  const std::size_t colon = address.rfind(':');
  if (colon == std::string::npos || colon == 0) return Fail(Bad(address, "it is not HOST:PORT"));
  AdminAddress parsed{address.substr(0, colon), -1};
  const char* end = address.data() + address.size();
  const auto [stop, error] = std::from_chars(address.data() + colon + 1, end, parsed.port);
  if (error != std::errc() || stop != end || parsed.port < 0 || parsed.port > kMaxPort) {
    return Fail(Bad(address, "the port is not a number from 0 to 65535"));
  }
  if (parsed.host.front() == '[' && parsed.host.back() == ']') {
    parsed.host = parsed.host.substr(1, parsed.host.size() - 2);
  }
  return parsed;
}

class AdminHttp::Impl {
 public:
  explicit Impl(AdminPages pages) : pages_(std::move(pages)) {
    // The library asks for the queue when it begins to listen, once.
    server_.new_task_queue = [this] {
      listening_.set_value();
      return new httplib::ThreadPool(kThreads);
    };
    server_.set_socket_options(OwnThePort);
    server_.set_read_timeout(kPatienceSeconds);
    server_.set_write_timeout(kPatienceSeconds);
    server_.set_payload_max_length(kLongestRequest);
    // Every answer closes, so that no idle connection keeps a thread.
    server_.set_keep_alive_max_count(1);
    server_.Get("/healthz", [](const httplib::Request&, httplib::Response& response) {
      response.set_content("{\"status\":\"alive\"}\n", "application/json");
    });
    server_.Get("/readyz", [this](const httplib::Request&, httplib::Response& response) {
      const Verdict verdict = pages_.readiness();
      response.status = HttpStatus(verdict.state);
      Answer(verdict, response);
    });
    server_.Get("/metrics", [this](const httplib::Request&, httplib::Response& response) {
      response.set_content(pages_.metrics(), "text/plain; version=0.0.4; charset=utf-8");
    });
  }

  ~Impl() {
    server_.stop();
    if (thread_.joinable()) thread_.join();
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  Status Start(const std::string& address) {
    TRY(const AdminAddress parsed, ParseAdminAddress(address));
    int port = parsed.port;
    const bool bound = port == 0 ? (port = server_.bind_to_any_port(parsed.host)) > 0
                                 : server_.bind_to_port(parsed.host, port);
    if (!bound) {
      Fault fault = Bad(address, "it is in use or not an address of this machine");
      fault.kind = FaultKind::kAlreadyExists;
      return Fail(std::move(fault));
    }
    address_ = address.substr(0, address.rfind(':') + 1) + std::to_string(port);
    thread_ = std::thread([this] { server_.listen_after_bind(); });
    // A stop() before it listens would be lost.
    listening_.get_future().wait();
    return {};
  }

  const std::string& address() const { return address_; }

 private:
  const AdminPages pages_;
  httplib::Server server_;
  std::string address_;
  std::promise<void> listening_;
  std::thread thread_;
};

Result<std::unique_ptr<AdminHttp>> AdminHttp::Start(const std::string& address, AdminPages pages) {
  auto impl = std::make_unique<Impl>(std::move(pages));
  CHECK_OK(impl->Start(address));
  return std::unique_ptr<AdminHttp>(new AdminHttp(std::move(impl)));
}

AdminHttp::AdminHttp(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

AdminHttp::~AdminHttp() = default;

const std::string& AdminHttp::address() const { return impl_->address(); }

}  // namespace arap::host
