#include "client/src/credentials.h"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <string_view>
#include <system_error>
#include <utility>

namespace arap::client::internal {
namespace {

using grpc::experimental::ClientInterceptorFactoryInterface;
using grpc::experimental::InterceptionHookPoints;
using grpc::experimental::Interceptor;

Fault Bad(const char* field, const std::string& message) {
  return Fault(FaultKind::kInvalidOption, message).Field(field);
}

// Whatever grpc connects to without leaving this machine.
bool IsLocal(std::string_view address) {
  if (address.starts_with("unix:")) return true;
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
  return Fail(Bad(field, path + " cannot be read: " + why));
}

class Sender final : public Interceptor {
 public:
  explicit Sender(const std::string& value) : value_(value) {}

  void Intercept(grpc::experimental::InterceptorBatchMethods* methods) override {
    if (methods->QueryInterceptionHookPoint(InterceptionHookPoints::PRE_SEND_INITIAL_METADATA)) {
      methods->GetSendInitialMetadata()->emplace("authorization", value_);
    }
    methods->Proceed();
  }

 private:
  const std::string& value_;
};

class SenderFactory final : public ClientInterceptorFactoryInterface {
 public:
  explicit SenderFactory(const std::string& token) : value_("Bearer " + token) {}

  Interceptor* CreateClientInterceptor(grpc::experimental::ClientRpcInfo* /*info*/) override {
    return new Sender(value_);
  }

 private:
  const std::string value_;  // lives as long as the channel, which the calls keep
};

}  // namespace

Status Check(const std::string& address, const ConnectOptions& options) {
  if (options.certificate.empty() != options.key.empty()) {
    return Fail(Bad(options.key.empty() ? "key" : "certificate",
                    "a client certificate and its key have to be given together"));
  }
  // What a header can carry.
  const bool clean = std::all_of(options.token.begin(), options.token.end(),
                                 [](char c) { return c > ' ' && c <= '~'; });
  if (!clean) return Fail(Bad("token", "the token has characters that no token has"));
  if (!options.token.empty() && !options.wants_tls() && !options.token_in_plaintext &&
      !IsLocal(address)) {
    return Fail(Bad("token", "the token would go to " + address +
                                 " in plaintext, for everyone on the way to read: use TLS"));
  }
  return {};
}

Result<std::shared_ptr<grpc::ChannelCredentials>> CredentialsOf(const ConnectOptions& options) {
  if (!options.wants_tls()) return grpc::InsecureChannelCredentials();
  auto roots = Slurp(options.root_certificates, "root_certificates");
  if (!roots) return Fail(std::move(roots.error()));
  auto key = Slurp(options.key, "key");
  if (!key) return Fail(std::move(key.error()));
  auto certificate = Slurp(options.certificate, "certificate");
  if (!certificate) return Fail(std::move(certificate.error()));
  return grpc::SslCredentials({*std::move(roots), *std::move(key), *std::move(certificate)});
}

Interceptors TokenSender(const ConnectOptions& options) {
  Interceptors interceptors;
  if (!options.token.empty()) {
    interceptors.push_back(std::make_unique<SenderFactory>(options.token));
  }
  return interceptors;
}

}  // namespace arap::client::internal
