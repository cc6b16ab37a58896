#include "server/host/access.h"

#include <algorithm>
#include <utility>

#include <grpcpp/security/server_credentials.h>
#include <spdlog/spdlog.h>

#include "server/host/listen.h"

namespace arap::host {
namespace {

void LogOutcome(const app::Tokens& tokens, const Status& reloaded) {
  if (reloaded) {
    spdlog::info("event=tokens_reloaded tokens={}", tokens.size());
  } else {
    spdlog::warn("event=tokens_kept reason=\"{}\"", reloaded.error().message);
  }
}

}  // namespace

Result<std::unique_ptr<Access>> Access::Open(const AccessOptions& options,
                                             const std::vector<std::string>& listen,
                                             const app::OwnerLimits& defaults,
                                             std::shared_ptr<const runtime::Clock> clock) {
  const bool demanded = !options.token_file.empty() || options.tls.require_client_certificate;
  const Exposure exposure{options.tls.given(), demanded, options.allow_plaintext,
                          options.allow_anyone};
  if (auto good = CheckExposure(listen, exposure); !good) return Fail(std::move(good.error()));
  auto tls = TlsFiles::Open(options.tls);
  if (!tls) return Fail(std::move(tls.error()));
  auto tcp = TcpCredentials((*tls)->copies());
  if (!tcp) return Fail(std::move(tcp.error()));

  std::unique_ptr<Access> access(new Access(std::move(clock)));
  access->tls_ = *std::move(tls);
  access->tcp_ = *std::move(tcp);
  access->identity_.demanded = demanded;
  access->identity_.limits = defaults;
  if (!options.token_file.empty()) {
    auto tokens = app::Tokens::Open(options.token_file, defaults, *access->clock_);
    if (!tokens) return Fail(std::move(tokens.error()));
    access->identity_.tokens = *std::move(tokens);
  }
  if (!access->identity_.tokens && !options.tls.given()) return access;
  const auto period = std::min<std::chrono::milliseconds>(
      options.refresh, std::chrono::seconds(options.tls.refresh_seconds));
  access->refresher_ = std::jthread([self = access.get(), period](const std::stop_token& stop) {
    self->KeepFresh(stop, period);
  });
  return access;
}

Access::~Access() = default;

std::shared_ptr<grpc::ServerCredentials> Access::CredentialsFor(const std::string& address) const {
  return UnixPath(address).empty() ? tcp_ : grpc::InsecureServerCredentials();
}

Status Access::Reload() {
  Status certificates = RefreshCertificates(true);
  if (!identity_.tokens) return certificates;
  const Status reloaded = identity_.tokens->Reload();
  LogOutcome(*identity_.tokens, reloaded);
  return reloaded ? certificates : reloaded;
}

Status Access::RefreshCertificates(bool insist) {
  const auto refreshed = tls_->Refresh(insist);
  if (refreshed && *refreshed) spdlog::info("event=certificates_reloaded");
  if (refreshed) return {};
  spdlog::warn("event=certificates_kept reason=\"{}\"", refreshed.error().message);
  return Fail(refreshed.error());
}

void Access::KeepFresh(const std::stop_token& stop, std::chrono::milliseconds period) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    waiting_.wait_for(lock, stop, period, [] { return false; });
    if (stop.stop_requested()) return;
    static_cast<void>(RefreshCertificates(false));
    if (!identity_.tokens) continue;
    const auto refreshed = identity_.tokens->Refresh();
    if (!refreshed) LogOutcome(*identity_.tokens, Fail(refreshed.error()));
    if (refreshed && *refreshed) LogOutcome(*identity_.tokens, {});
  }
}

}  // namespace arap::host
