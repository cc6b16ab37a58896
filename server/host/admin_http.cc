#include "server/host/admin_http.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include "core/base/try.h"

namespace arap::host {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr std::size_t kMostClients = 128;
constexpr milliseconds kPatience{2'000};
constexpr std::size_t kLongestRequest = 8'192;
constexpr const char* kJson = "application/json";

int HttpStatus(Verdict::State state) {
  constexpr int kOk = 200, kNotFound = 404, kUnavailable = 503;
  if (state == Verdict::State::kReady) return kOk;
  return state == Verdict::State::kDraining ? kNotFound : kUnavailable;
}

const char* Meaning(int status) {
  switch (status) {
    case 200:
      return "OK";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 503:
      return "Service Unavailable";
    default:
      return "Bad Request";
  }
}

// Every answer closes, so that no idle connection takes a place.
std::string Page(int status, const char* type, std::string_view body, bool head_only = false) {
  return fmt::format(
      "HTTP/1.1 {} {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nConnection: close\r\n\r\n{}",
      status, Meaning(status), type, body.size(), head_only ? std::string_view() : body);
}

std::string Body(const Verdict& verdict) {
  nlohmann::json body{{"status", StateName(verdict.state)}};
  if (!verdict.why.empty()) body["why"] = verdict.why;
  return body.dump() + "\n";
}

}  // namespace

struct AdminHttp::Client {
  Descriptor socket;
  steady_clock::time_point end;
  std::string request = {};
  std::string answer = {};  // empty until the request is complete
  std::size_t sent = 0;
};

Result<std::unique_ptr<AdminHttp>> AdminHttp::Start(const std::string& address, AdminPages pages) {
  TRY(auto listening, Listening::Open(address, kForOperators));
  return std::unique_ptr<AdminHttp>(new AdminHttp(std::move(listening), std::move(pages)));
}

AdminHttp::AdminHttp(Listening listening, AdminPages pages)
    : listening_(std::move(listening)),
      pages_(std::move(pages)),
      wake_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
      thread_([this] { Run(); }) {}

AdminHttp::~AdminHttp() {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = write(wake_.number(), &one, sizeof one);
  thread_.join();
}

void AdminHttp::Run() {
  std::vector<Client> clients;  // the oldest first
  std::vector<pollfd> waits;
  for (;;) {
    waits.assign(1, {wake_.number(), POLLIN, 0});
    for (const Descriptor& listener : listening_.sockets()) {
      waits.push_back({listener.number(), POLLIN, 0});
    }
    for (const Client& client : clients) {
      const short events = client.answer.empty() ? POLLIN : POLLOUT;
      waits.push_back({client.socket.number(), events, 0});
    }
    int pause = -1;
    if (!clients.empty()) {
      const auto left = clients.front().end - steady_clock::now();
      pause = std::max(0, static_cast<int>(std::chrono::ceil<milliseconds>(left).count()));
    }
    poll(waits.data(), waits.size(), pause);
    if (waits[0].revents != 0) return;
    const auto now = steady_clock::now();
    std::size_t wait = 1 + listening_.sockets().size();
    std::erase_if(clients, [&](Client& client) {
      const bool ready = waits[wait++].revents != 0;
      return (ready && !Serve(client)) || client.end <= now;
    });
    for (std::size_t i = 0; i < listening_.sockets().size(); ++i) {
      if (waits[i + 1].revents != 0) Accept(listening_.sockets()[i], clients);
    }
  }
}

void AdminHttp::Accept(const Descriptor& listener, std::vector<Client>& clients) {
  // At most a quarter of the places at a time, so that whoever has just come in is heard first.
  for (std::size_t i = 0; i < kMostClients / 4; ++i) {
    Descriptor accepted(accept4(listener.number(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (accepted.number() < 0) {
      // Without descriptors the oldest client makes room for the next.
      if ((errno == EMFILE || errno == ENFILE) && !clients.empty()) clients.erase(clients.begin());
      return;
    }
    if (clients.size() >= kMostClients) clients.erase(clients.begin());
    clients.push_back({std::move(accepted), steady_clock::now() + kPatience});
    // Most requests are there already.
    if (!Serve(clients.back())) clients.pop_back();
  }
}

bool AdminHttp::Serve(Client& client) const {
  const int socket = client.socket.number();
  if (client.answer.empty()) {
    std::array<char, 4'096> buffer{};
    const ssize_t count = recv(socket, buffer.data(), buffer.size(), 0);
    if (count < 0) return errno == EAGAIN || errno == EINTR;
    if (count == 0) return false;
    client.request.append(buffer.data(), static_cast<std::size_t>(count));
    if (client.request.find("\r\n\r\n") == std::string::npos) {
      if (client.request.size() <= kLongestRequest) return true;
      client.answer = Page(400, "text/plain", "The request is too long.\n");
    } else {
      client.answer = AnswerTo(client.request);
    }
  }
  const std::string_view rest = std::string_view(client.answer).substr(client.sent);
  const ssize_t count = send(socket, rest.data(), rest.size(), MSG_NOSIGNAL);
  if (count < 0) return errno == EAGAIN || errno == EINTR;
  client.sent += static_cast<std::size_t>(count);
  if (client.sent < client.answer.size()) return true;
  shutdown(socket, SHUT_WR);
  return false;
}

std::string AdminHttp::AnswerTo(const std::string& request) const {
  const std::string_view line = std::string_view(request).substr(0, request.find("\r\n"));
  const std::size_t first = line.find(' ');
  const std::size_t second = line.find(' ', first + 1);
  if (first == std::string_view::npos || second == std::string_view::npos ||
      !line.substr(second + 1).starts_with("HTTP/1.")) {
    return Page(400, "text/plain", "This is not HTTP/1.\n");
  }
  const std::string_view method = line.substr(0, first);
  std::string_view path = line.substr(first + 1, second - first - 1);
  path = path.substr(0, path.find('?'));
  const bool head = method == "HEAD";
  if (method != "GET" && !head) return Page(405, "text/plain", "Only GET and HEAD.\n");
  if (path == "/healthz") return Page(200, kJson, "{\"status\":\"alive\"}\n", head);
  if (path == "/readyz") {
    const Verdict verdict = pages_.readiness();
    return Page(HttpStatus(verdict.state), kJson, Body(verdict), head);
  }
  if (path == "/metrics") {
    return Page(200, "text/plain; version=0.0.4; charset=utf-8", pages_.metrics(), head);
  }
  return Page(404, "text/plain", "No such page.\n", head);
}

}  // namespace arap::host
