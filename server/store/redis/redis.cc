#include "server/store/redis/redis.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <ctime>
#include <utility>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>
#include <pthread.h>

#include "core/base/try.h"
#include "core/token/digest.h"
#include "server/store/store.h"

namespace arap::store {
namespace {

// hiredis and OpenSSL write to sockets without MSG_NOSIGNAL. Keeps SIGPIPE from this thread, and
// swallows the one that came meanwhile; the handler of the process stays as it is.
class NoSigpipe {
 public:
  NoSigpipe() {
    sigemptyset(&pipe_);
    sigaddset(&pipe_, SIGPIPE);
    sigset_t pending;
    sigpending(&pending);
    was_pending_ = sigismember(&pending, SIGPIPE) == 1;
    pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
  }
  ~NoSigpipe() {
    const timespec none{};
    if (!was_pending_) {
      while (sigtimedwait(&pipe_, nullptr, &none) < 0 && errno == EINTR) {
      }
    }
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  NoSigpipe(const NoSigpipe&) = delete;
  NoSigpipe& operator=(const NoSigpipe&) = delete;

 private:
  sigset_t pipe_{};
  sigset_t before_{};
  bool was_pending_ = false;
};

timeval ToTimeval(std::chrono::milliseconds time) {
  return {time.count() / 1000, (time.count() % 1000) * 1000};
}

using TlsContext = std::unique_ptr<SSL_CTX, void (*)(SSL_CTX*)>;

// A key that wants a passphrase is refused: nobody is asked on the terminal.
int NoPassphrase(char*, int, int, void*) { return -1; }

Result<TlsContext> OpenTls(const RedisTls& files) {
  const auto bad = [](const char* field, const std::string& what) {
    ERR_clear_error();
    return Fail(Fault(FaultKind::kInvalidOption, what).Field(field));
  };
  TlsContext context(SSL_CTX_new(TLS_client_method()), &SSL_CTX_free);
  if (context == nullptr) return Fail(FaultKind::kInternal, "OpenSSL makes no context.");
  SSL_CTX_set_min_proto_version(context.get(), TLS1_2_VERSION);
  SSL_CTX_set_verify(context.get(), SSL_VERIFY_PEER, nullptr);
  SSL_CTX_set_default_passwd_cb(context.get(), NoPassphrase);
  const bool trusts = files.ca.empty() ? SSL_CTX_set_default_verify_paths(context.get()) == 1
                                       : SSL_CTX_load_verify_locations(
                                             context.get(), files.ca.c_str(), nullptr) == 1;
  if (!trusts) return bad("redis_ca", files.ca + " has no certificate in PEM that can be read.");
  if (files.certificate.empty()) return context;
  if (SSL_CTX_use_certificate_chain_file(context.get(), files.certificate.c_str()) != 1) {
    return bad("redis_cert", files.certificate + " has no certificate in PEM that can be read.");
  }
  if (SSL_CTX_use_PrivateKey_file(context.get(), files.key.c_str(), SSL_FILETYPE_PEM) != 1 ||
      SSL_CTX_check_private_key(context.get()) != 1) {
    return bad("redis_key", files.key +
                                " has no private key in PEM, without a passphrase, that is "
                                "that of the certificate.");
  }
  return context;
}

bool IsAddress(const std::string& host) {
  std::array<unsigned char, sizeof(in6_addr)> address{};
  return inet_pton(AF_INET, host.c_str(), address.data()) == 1 ||
         inet_pton(AF_INET6, host.c_str(), address.data()) == 1;
}

bool ExpectHost(SSL* tls, const std::string& host) {
  if (IsAddress(host)) {
    return X509_VERIFY_PARAM_set1_ip_asc(SSL_get0_param(tls), host.c_str()) == 1;
  }
  // What SSL_set_tlsext_host_name is a macro for, without its cast.
  std::string name = host;
  return SSL_set1_host(tls, host.c_str()) == 1 &&
         SSL_ctrl(tls, SSL_CTRL_SET_TLSEXT_HOSTNAME, TLSEXT_NAMETYPE_host_name, name.data()) == 1;
}

}  // namespace

Status CheckTls(const RedisTls& files) {
  CHECK_OK(OpenTls(files));
  return {};
}

RedisScript::RedisScript(std::string the_text)
    : text(std::move(the_text)), sha1(Sha1Hex(text).value_or("")) {}

Fault FaultOf(const RedisReply& error) {
  const std::string text = error.Text();
  return Unavailable(fmt::format("Redis refuses with {}", text.substr(0, text.find(' '))));
}

bool RedisReply::IsError(std::string_view word) const {
  if (!IsError()) return false;
  const std::string text = Text();
  return std::string_view(text).substr(0, text.find(' ')) == word;
}

std::string RedisReply::TextOf(const redisReply* reply) {
  if (reply->str == nullptr) return {};
  return {reply->str, reply->len};
}

std::vector<std::string> RedisReply::Texts() const {
  std::vector<std::string> texts;
  if (reply_->type != REDIS_REPLY_ARRAY) return texts;
  for (std::size_t i = 0; i < reply_->elements; ++i) texts.push_back(TextOf(reply_->element[i]));
  return texts;
}

void RedisConnection::Free::operator()(SSL* tls) const { SSL_free(tls); }

Result<std::unique_ptr<RedisConnection>> RedisConnection::Open(const RedisPlace& place,
                                                               const RedisAccess& access,
                                                               std::chrono::milliseconds timeout) {
  std::unique_ptr<RedisConnection> connection(new RedisConnection);
  const timeval limit = ToTimeval(timeout);
  connection->context_.reset(redisConnectWithTimeout(place.host.c_str(), place.port, limit));
  redisContext* context = connection->context_.get();
  if (context == nullptr || context->err != 0) return Fail(Unavailable("Redis cannot be reached"));
  redisEnableKeepAlive(context);
  if (redisSetTimeout(context, limit) != REDIS_OK) {
    return Fail(Unavailable("Redis cannot be reached"));
  }
  if (access.tls) {
    CHECK_OK(connection->Secure(*access.tls, place.host));
  }
  CHECK_OK(connection->Greet(access));
  return connection;
}

Status RedisConnection::Secure(const RedisTls& files, const std::string& host) {
  const NoSigpipe guard;
  const auto context = OpenTls(files);
  if (!context) return Fail(Unavailable("the certificate files for Redis cannot be used"));
  tls_.reset(SSL_new(context->get()));
  if (tls_ == nullptr || SSL_set_fd(tls_.get(), context_->fd) != 1 ||
      !ExpectHost(tls_.get(), host)) {
    return Fail(Unavailable("OpenSSL makes no connection"));
  }
  const int result = SSL_connect(tls_.get());
  timed_out_ = SSL_get_error(tls_.get(), result) == SSL_ERROR_WANT_READ;
  const long verdict = SSL_get_verify_result(tls_.get());
  ERR_clear_error();
  if (result == 1) return {};
  if (timed_out_) return Fail(Unavailable("Redis does not answer in time"));
  if (verdict == X509_V_OK) return Fail(Unavailable("Redis does not speak TLS with this server"));
  return Fail(Unavailable(fmt::format("the certificate of Redis cannot be trusted: {}",
                                      X509_verify_cert_error_string(verdict))));
}

// Redis' own words are not passed on: they may repeat what was sent, the password too.
Status RedisConnection::Greet(const RedisAccess& access) {
  std::vector<RedisCommand> commands;
  const bool named = !access.user.empty() || !access.password.empty();
  if (!access.user.empty()) {
    commands.push_back({"AUTH", access.user, access.password});
  } else if (named) {
    commands.push_back({"AUTH", access.password});
  }
  if (access.database != 0) commands.push_back({"SELECT", std::to_string(access.database)});
  if (commands.empty()) return {};
  TRY(auto replies, Run(commands));
  if (named && replies.front().IsError()) {
    return Fail(Unavailable(access.user.empty() ? "Redis does not accept the password"
                                                : "Redis does not accept user and password"));
  }
  if (replies.back().IsError()) return Fail(Unavailable("Redis does not have the database"));
  return {};
}

bool RedisConnection::Send(const std::vector<RedisCommand>& commands) {
  std::string bytes;  // with TLS
  for (const RedisCommand& command : commands) {
    std::vector<const char*> parts;
    std::vector<std::size_t> sizes;
    for (const std::string& part : command) {
      parts.push_back(part.data());
      sizes.push_back(part.size());
    }
    const int count = static_cast<int>(parts.size());
    if (tls_ == nullptr) {
      // Written with the first reply that is asked for.
      redisAppendCommandArgv(context_.get(), count, parts.data(), sizes.data());
      continue;
    }
    char* text = nullptr;
    const int length = redisFormatCommandArgv(&text, count, parts.data(), sizes.data());
    if (length < 0) return false;
    bytes.append(text, static_cast<std::size_t>(length));
    redisFreeCommand(text);
  }
  if (tls_ == nullptr || bytes.empty()) return true;
  std::size_t written = 0;
  const int result = SSL_write_ex(tls_.get(), bytes.data(), bytes.size(), &written);
  timed_out_ = result != 1 && SSL_get_error(tls_.get(), result) == SSL_ERROR_WANT_WRITE;
  ERR_clear_error();
  return result == 1;
}

// More bytes for the reader.
bool RedisConnection::ReadTls() {
  std::array<char, 16'384> bytes{};
  std::size_t size = 0;
  const int result = SSL_read_ex(tls_.get(), bytes.data(), bytes.size(), &size);
  if (result == 1) return redisReaderFeed(context_->reader, bytes.data(), size) == REDIS_OK;
  timed_out_ = SSL_get_error(tls_.get(), result) == SSL_ERROR_WANT_READ;
  ERR_clear_error();
  return false;
}

bool RedisConnection::Receive(void** reply) {
  if (tls_ == nullptr) {
    if (redisGetReply(context_.get(), reply) == REDIS_OK && *reply != nullptr) return true;
    timed_out_ = context_->err == REDIS_ERR_IO && (errno == EAGAIN || errno == EWOULDBLOCK);
    return false;
  }
  do {
    if (redisReaderGetReply(context_->reader, reply) != REDIS_OK) return false;
  } while (*reply == nullptr && ReadTls());
  return *reply != nullptr;
}

Result<std::vector<RedisReply>> RedisConnection::Run(const std::vector<RedisCommand>& commands) {
  const NoSigpipe guard;
  std::vector<RedisReply> replies;
  bool good = Send(commands);
  for (std::size_t i = 0; good && i < commands.size(); ++i) {
    void* reply = nullptr;
    good = Receive(&reply);
    if (good) replies.emplace_back(static_cast<redisReply*>(reply));
  }
  if (good) return replies;
  return Fail(
      Unavailable(timed_out_ ? "Redis does not answer in time" : "the connection to Redis broke"));
}

Result<RedisReply> RedisConnection::Run(const RedisCommand& command) {
  TRY(auto replies, Run(std::vector<RedisCommand>{command}));
  if (replies.front().IsError()) return Fail(FaultOf(replies.front()));
  return std::move(replies.front());
}

}  // namespace arap::store
