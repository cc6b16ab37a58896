#include "client/cli/connect/connection.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/try.h"
#include "core/files/text_file.h"

// The header of glibc 2.36 forgets that C++ may include it.
extern "C" {
#include <sys/pidfd.h>
}

namespace arap::cli {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kStartTimeout{30'000};
constexpr milliseconds kStopTimeout{15'000};
// A socket's path may have 107 bytes; a longer directory for temporary files is not used.
constexpr std::size_t kLongestDirectory = 80;

auto SystemFault(std::string_view what) {
  return Fail(FaultKind::kInternal,
              fmt::format("{}: {}.", what, std::generic_category().message(errno)));
}

std::string FindServer() {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::string beside = (self.parent_path() / "arapd").string();
  if (!error && access(beside.c_str(), X_OK) == 0) return beside;
  return "arapd";  // execvp searches PATH
}

// The child's side: only calls that are safe between fork and exec.
[[noreturn]] void BecomeServer(char* const* arguments, int output, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(0);  // the parent died before the line above
  dup2(output, STDOUT_FILENO);
  execvp(arguments[0], arguments);
  constexpr std::string_view kMessage = "arapctl: cannot run arapd\n";
  [[maybe_unused]] const auto written = write(STDERR_FILENO, kMessage.data(), kMessage.size());
  _exit(127);
}

// The token of the file, else of the environment, else none.
Result<std::string> ReadToken(const std::string& path) {
  if (!path.empty()) return ReadTokenFile(path);
  const char* const token = std::getenv(kTokenVariable);  // NOLINT(concurrency-mt-unsafe)
  return std::string(token == nullptr ? "" : token);
}

Result<client::ConnectOptions> OptionsOf(const ServerFlags& flags) {
  client::ConnectOptions options = flags.connect;
  // A private server is on a socket that only we know.
  if (flags.spawn) return options;
  TRY(options.token, ReadToken(flags.token_file));
  return options;
}

// Connects and waits until the connection stands.
Result<client::Client> ConnectReady(const std::string& address,
                                    const client::ConnectOptions& options) {
  constexpr std::chrono::seconds kTimeout{5};
  TRY(client::Client client, client::Client::Connect(address, options));
  if (const Status ready = client.WaitReady(kTimeout); !ready) {
    Fault fault = ready.error();
    fault.message = "Cannot reach " + address + ": " + fault.message +
                    (options.wants_tls()
                         ? " (does it speak TLS, with a certificate that --tls-ca vouches for and "
                           "the name of its address?)"
                         : " (if it speaks TLS, give --tls or --tls-ca)");
    return Fail(std::move(fault));
  }
  return client;
}

}  // namespace

Result<std::string> ReadTokenFile(const std::string& path) {
  TRY(std::string token, ReadTextFile(path));
  token.erase(token.find_last_not_of(" \t\r\n") + 1);
  if (token.empty()) return Fail(FaultKind::kInvalidOption, path + " holds no token.");
  return token;
}

void AddServerFlags(CLI::App& command, ServerFlags& flags) {
  auto* group = command.add_option_group("Server", "which server to use");
  group->add_option("--server", flags.server, "a running server: host:port or unix:PATH")
      ->option_text("ADDRESS");
  auto* const spawn =
      group->add_flag("--spawn", flags.spawn, "run a private arapd for the length of the command");
  group->require_option(1);

  auto* identity = command.add_option_group("Identity", "who is asking, and how it travels");
  client::ConnectOptions& connect = flags.connect;
  const auto option = [&](const char* name, std::string& value, const char* help,
                          const char* text = "FILE.pem") {
    identity->add_option(name, value, help)->excludes(spawn)->option_text(text);
  };
  const auto flag = [&](const char* name, bool& value, const char* help) {
    identity->add_flag(name, value, help)->excludes(spawn);
  };
  option("--token-file", flags.token_file,
         "file with the bearer token; without it the variable ARAPCTL_TOKEN counts", "FILE");
  option("--as-user", connect.user,
         "the user that the call is for, with the token of a gateway (role gateway)", "NAME");
  flag("--token-in-plaintext", connect.token_in_plaintext,
       "send the token to another machine without TLS, for everyone on the way to read");
  flag("--tls", connect.tls, "speak TLS; the other --tls flags imply it");
  option("--tls-ca", connect.root_certificates,
         "PEM file of who vouches for the server (default: the system's authorities)");
  option("--tls-cert", connect.certificate, "PEM file of the client's own certificate");
  option("--tls-key", connect.key, "PEM file of its private key");
  option("--tls-server-name", connect.server_name,
         "the name in the server's certificate, unless it is that of the address", "NAME");
}

// A private arapd: the one beside our own executable, else the one in PATH, on a unix socket in a
// fresh directory. It is stopped and the directory removed when this goes; it dies with us too.
class Connection::SpawnedServer {
 public:
  // Waits until the server listens. Its standard error is ours.
  static Result<std::unique_ptr<SpawnedServer>> Start();

  SpawnedServer(const SpawnedServer&) = delete;
  SpawnedServer& operator=(const SpawnedServer&) = delete;
  ~SpawnedServer();

  const std::string& address() const { return address_; }

 private:
  SpawnedServer() = default;
  Status Launch();
  Status AwaitListening();

  std::string directory_;  // empty: nothing to remove
  std::string address_;
  pid_t pid_ = -1;   // -1: nothing to stop
  int output_ = -1;  // reading end of the server's standard output
};

Result<std::unique_ptr<Connection::SpawnedServer>> Connection::SpawnedServer::Start() {
  std::unique_ptr<SpawnedServer> server(new SpawnedServer);
  std::error_code error;
  std::string base = std::filesystem::temp_directory_path(error).string();
  if (error || base.size() > kLongestDirectory) base = "/tmp";
  std::string pattern = base + "/arapctl-XXXXXX";
  if (mkdtemp(pattern.data()) == nullptr) return SystemFault("Cannot make " + pattern);
  server->directory_ = pattern;
  CHECK_OK(server->Launch());
  CHECK_OK(server->AwaitListening());
  return server;
}

Status Connection::SpawnedServer::Launch() {
  std::string program = FindServer();
  std::string listen = "unix:" + directory_ + "/arapd.sock";
  std::string listen_flag = "--listen", level_flag = "--log-level", level = "warn";
  std::string store_flag = "--store", store = "memory", no_admin_flag = "--no-admin";
  std::string echo_flag = "--echo";
  const std::array<char*, 10> arguments{
      program.data(),    listen_flag.data(), listen.data(),        level_flag.data(), level.data(),
      store_flag.data(), store.data(),       no_admin_flag.data(), echo_flag.data(),  nullptr};
  std::array<int, 2> pipe_ends{};
  if (pipe2(pipe_ends.data(), O_CLOEXEC) != 0) return SystemFault("Cannot make a pipe");
  output_ = pipe_ends[0];
  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid == 0) BecomeServer(arguments.data(), pipe_ends[1], parent);
  close(pipe_ends[1]);
  if (pid < 0) return SystemFault("Cannot start arapd");
  pid_ = pid;
  return {};
}

Status Connection::SpawnedServer::AwaitListening() {
  constexpr std::string_view kLine = "arapd listening on ";
  const auto deadline = steady_clock::now() + kStartTimeout;
  std::string text;
  std::array<char, 512> buffer{};
  for (;;) {
    if (const std::size_t at = text.find(kLine); at != std::string::npos) {
      if (const std::size_t end = text.find('\n', at); end != std::string::npos) {
        address_ = text.substr(at + kLine.size(), end - at - kLine.size());
        return {};
      }
    }
    const auto left = std::chrono::duration_cast<milliseconds>(deadline - steady_clock::now());
    pollfd wait{output_, POLLIN, 0};
    const int ready = left.count() > 0 ? poll(&wait, 1, static_cast<int>(left.count())) : 0;
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0)
      return Fail(FaultKind::kDeadlineExceeded,
                  fmt::format("arapd did not listen within {} s.", kStartTimeout.count() / 1000));
    const ssize_t count = read(output_, buffer.data(), buffer.size());
    if (count <= 0) return Fail(FaultKind::kInternal, "arapd ended before it was listening.");
    text.append(buffer.data(), static_cast<std::size_t>(count));
  }
}

Connection::SpawnedServer::~SpawnedServer() {
  if (pid_ > 0) {
    kill(pid_, SIGTERM);
    // A server that does not go is killed.
    if (const int handle = pidfd_open(pid_, 0); handle >= 0) {
      pollfd wait{handle, POLLIN, 0};
      if (poll(&wait, 1, static_cast<int>(kStopTimeout.count())) <= 0) kill(pid_, SIGKILL);
      close(handle);
    }
    while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  if (output_ >= 0) close(output_);
  if (!directory_.empty()) {
    std::error_code ignored;
    std::filesystem::remove_all(directory_, ignored);
  }
}

Result<Connection> Connection::Open(const ServerFlags& flags) {
  TRY(auto opened, OpenAll({flags}));
  return std::move(opened.front());
}

Result<std::vector<Connection>> Connection::OpenAll(const std::vector<ServerFlags>& flags) {
  std::vector<client::ConnectOptions> options;
  for (const ServerFlags& one : flags) {
    TRY(options.emplace_back(), OptionsOf(one));
  }
  std::vector<std::unique_ptr<SpawnedServer>> spawned(flags.size());
  for (std::size_t i = 0; i < flags.size(); ++i) {
    if (!flags[i].spawn) continue;
    TRY(spawned[i], SpawnedServer::Start());
  }
  std::vector<Connection> connections;
  for (std::size_t i = 0; i < flags.size(); ++i) {
    std::string address = spawned[i] ? spawned[i]->address() : flags[i].server;
    TRY(client::Client client, ConnectReady(address, options[i]));
    connections.push_back(Connection(std::move(spawned[i]), std::move(address),
                                     std::move(options[i]), std::move(client)));
  }
  return connections;
}

Connection::Connection(std::unique_ptr<SpawnedServer> spawned, std::string address,
                       client::ConnectOptions options, client::Client client)
    : spawned_(std::move(spawned)),
      address_(std::move(address)),
      options_(std::move(options)),
      client_(std::move(client)) {}

Connection::Connection(Connection&& other) noexcept = default;
Connection& Connection::operator=(Connection&& other) noexcept = default;
Connection::~Connection() = default;

}  // namespace arap::cli
