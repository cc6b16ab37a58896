#include "client/src/channel.h"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <grpcpp/security/credentials.h>
#include <grpcpp/support/client_interceptor.h>

#include "core/base/names.h"
#include "core/base/try.h"

namespace arap::client::internal {
namespace {

using grpc::experimental::ClientInterceptorFactoryInterface;
using grpc::experimental::InterceptionHookPoints;
using grpc::experimental::Interceptor;

using Interceptors = std::vector<std::unique_ptr<ClientInterceptorFactoryInterface>>;

Fault Bad(const char* field, const std::string& message) {
  return Fault(FaultKind::kInvalidOption, message).Field(field);
}

// Whatever grpc connects to without leaving this machine.
bool IsLocal(std::string_view address) {
  if (address.starts_with("unix:") || address.starts_with("unix-abstract:")) return true;
  for (const std::string_view scheme : {"dns:///", "dns:", "ipv4:", "ipv6:"}) {
    if (!address.starts_with(scheme)) continue;
    address.remove_prefix(scheme.size());
    break;
  }
  const std::string_view host = address.substr(0, address.rfind(':'));
  return host == "localhost" || host == "[::1]" ||
         (host.starts_with("127.") &&
          host.find_first_not_of("0123456789.") == std::string_view::npos);
}

// An empty text for no path.
Result<std::string> Slurp(const std::string& path, const char* field) {
  if (path.empty()) return std::string();
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  if (file.is_open() && !file.bad() && !text.empty()) return text;
  const std::string why = errno != 0 ? std::generic_category().message(errno) : "it is empty";
  return Fail(Bad(field, path + " cannot be read: " + why + "."));
}

using Headers = std::vector<std::pair<std::string, std::string>>;

class Sender final : public Interceptor {
 public:
  explicit Sender(const Headers& headers) : headers_(headers) {}

  void Intercept(grpc::experimental::InterceptorBatchMethods* methods) override {
    if (methods->QueryInterceptionHookPoint(InterceptionHookPoints::PRE_SEND_INITIAL_METADATA)) {
      for (const auto& [name, value] : headers_) {
        methods->GetSendInitialMetadata()->emplace(name, value);
      }
    }
    methods->Proceed();
  }

 private:
  const Headers& headers_;
};

class SenderFactory final : public ClientInterceptorFactoryInterface {
 public:
  explicit SenderFactory(Headers headers) : headers_(std::move(headers)) {}

  Interceptor* CreateClientInterceptor(grpc::experimental::ClientRpcInfo* /*info*/) override {
    return new Sender(headers_);
  }

 private:
  const Headers headers_;  // live as long as the channel, which the calls keep
};

// kInvalidOption with the field: a certificate without key or the other way round, a token that is
// none or that would travel in plaintext to another machine.
Status Check(const std::string& address, const ConnectOptions& options) {
  if (options.certificate.empty() != options.key.empty()) {
    return Fail(Bad(options.key.empty() ? "key" : "certificate",
                    "A client certificate and its key have to be given together."));
  }
  // What a header can carry.
  const bool clean = std::all_of(options.token.begin(), options.token.end(),
                                 [](char c) { return c > ' ' && c <= '~'; });
  if (!clean) return Fail(Bad("token", "The token has characters that no token has."));
  if (!options.user.empty()) CHECK_OK(CheckName(options.user, "user"));
  if (!options.token.empty() && !options.wants_tls() && !options.token_in_plaintext &&
      !IsLocal(address)) {
    return Fail(Bad("token", "The token would go to " + address +
                                 " in plaintext, for everyone on the way to read: use TLS."));
  }
  return {};
}

// Reads the files. kInvalidOption with the field for one that cannot be read.
Result<std::shared_ptr<grpc::ChannelCredentials>> CredentialsOf(const ConnectOptions& options) {
  if (!options.wants_tls()) return grpc::InsecureChannelCredentials();
  grpc::SslCredentialsOptions files;
  TRY(files.pem_root_certs, Slurp(options.root_certificates, "root_certificates"));
  TRY(files.pem_private_key, Slurp(options.key, "key"));
  TRY(files.pem_cert_chain, Slurp(options.certificate, "certificate"));
  return grpc::SslCredentials(files);
}

// What adds the token and the gateway's user to every call, on secure channels and others.
Interceptors IdentitySender(const ConnectOptions& options) {
  Headers headers;
  if (!options.token.empty()) headers.emplace_back("authorization", "Bearer " + options.token);
  if (!options.user.empty()) headers.emplace_back("x-arapd-owner", options.user);
  Interceptors interceptors;
  if (!headers.empty()) interceptors.push_back(std::make_unique<SenderFactory>(std::move(headers)));
  return interceptors;
}

grpc::ChannelArguments Arguments(std::string_view address) {
  grpc::ChannelArguments arguments;
  // What http_proxy names cannot reach this machine; it is asked for other machines alone.
  if (IsLocal(address)) arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  arguments.SetMaxReceiveMessageSize(kMaxMessageBytes);
  arguments.SetMaxSendMessageSize(kMaxMessageBytes);
  // A server that is back is found soon: by default pauses grow to two minutes.
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 100);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 2'000);
  // Channels to one address share a connection unless each has its own pool.
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  return arguments;
}

}  // namespace

Channel::Channel(const std::string& address)
    : Channel([address] {
        return grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(),
                                         Arguments(address));
      }) {}

Result<std::shared_ptr<Channel>> Channel::Open(const std::string& address,
                                               const ConnectOptions& options) {
  CHECK_OK(Check(address, options));
  TRY(const auto credentials, CredentialsOf(options));
  grpc::ChannelArguments arguments = Arguments(address);
  if (!options.server_name.empty()) arguments.SetSslTargetNameOverride(options.server_name);
  return std::shared_ptr<Channel>(new Channel([address, credentials, arguments, options] {
    return grpc::experimental::CreateCustomChannelWithInterceptors(address, credentials, arguments,
                                                                   IdentitySender(options));
  }));
}

std::shared_ptr<Channel> Channel::Another() const {
  return std::shared_ptr<Channel>(new Channel(connect_));
}

Channel::Channel(Connect connect)
    : connect_(std::move(connect)),
      channel_(connect_()),
      deformation_(v1::DeformationService::NewStub(channel_)),
      flattening_(v1::FlatteningService::NewStub(channel_)),
      server_(v1::ServerService::NewStub(channel_)) {}

}  // namespace arap::client::internal
