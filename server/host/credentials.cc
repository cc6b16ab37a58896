#include "server/host/credentials.h"

#include <algorithm>
#include <utility>

#include <grpcpp/security/server_credentials.h>
#include <spdlog/spdlog.h>

#include "core/base/try.h"
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

Result<std::unique_ptr<Credentials>> Credentials::Open(
    const CredentialOptions& options, const std::vector<std::string>& listen,
    const OwnerLimits& defaults, std::shared_ptr<const runtime::Clock> clock) {
  const bool demanded = !options.token_file.empty() || options.tls.require_client_certificate;
  const Exposure exposure{options.tls.given(), demanded, options.allow_plaintext,
                          options.allow_anyone};
  CHECK_OK(CheckExposure(listen, exposure));
  TRY(auto tls, TlsFiles::Open(options.tls));
  TRY(auto tcp, TcpCredentials(tls->copies()));

  std::unique_ptr<Credentials> credentials(new Credentials(std::move(clock)));
  credentials->tls_ = std::move(tls);
  credentials->tcp_ = std::move(tcp);
  credentials->identity_.demanded = demanded;
  credentials->identity_.limits = defaults;
  if (!options.token_file.empty()) {
    TRY(credentials->identity_.tokens,
        app::Tokens::Open(options.token_file, defaults, *credentials->clock_));
  }
  if (!credentials->identity_.tokens && !options.tls.given()) return credentials;
  const auto period = std::min<std::chrono::milliseconds>(
      options.refresh, std::chrono::seconds(options.tls.refresh_seconds));
  credentials->refresher_ =
      std::make_unique<runtime::Ticker>(period, [self = credentials.get()] { self->Refresh(); });
  return credentials;
}

Credentials::~Credentials() = default;

std::shared_ptr<grpc::ServerCredentials> Credentials::CredentialsFor(
    const std::string& address) const {
  return UnixPath(address).empty() ? tcp_ : grpc::InsecureServerCredentials();
}

Status Credentials::Reload() {
  Status certificates = RefreshCertificates(true);
  if (!identity_.tokens) return certificates;
  const Status reloaded = identity_.tokens->Reload();
  LogOutcome(*identity_.tokens, reloaded);
  return reloaded ? certificates : reloaded;
}

Status Credentials::RefreshCertificates(bool insist) {
  const auto refreshed = tls_->Refresh(insist);
  if (refreshed && *refreshed) spdlog::info("event=certificates_reloaded");
  if (refreshed) return {};
  spdlog::warn("event=certificates_kept reason=\"{}\"", refreshed.error().message);
  return Fail(refreshed.error());
}

void Credentials::Refresh() {
  static_cast<void>(RefreshCertificates(false));
  if (!identity_.tokens) return;
  const auto refreshed = identity_.tokens->Refresh();
  if (!refreshed) LogOutcome(*identity_.tokens, Fail(refreshed.error()));
  if (refreshed && *refreshed) LogOutcome(*identity_.tokens, {});
}

}  // namespace arap::host
