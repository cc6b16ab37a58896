#include "server/rpc/caller_of.h"

#include <chrono>
#include <optional>
#include <string_view>
#include <utility>

#include <grpcpp/security/auth_context.h>
#include <grpcpp/server_context.h>

#include "core/base/names.h"
#include "core/base/try.h"
#include "server/runtime/worker_pool.h"

namespace arap::rpc {
namespace {

constexpr const char* kHeader = "authorization";
constexpr const char* kUserHeader = "x-arapd-owner";
// gRPC's name for it; there is a value only when the handshake has verified the certificate.
constexpr const char* kCommonName = "x509_common_name";

std::string_view View(const grpc::string_ref& text) { return {text.data(), text.size()}; }

auto Refused(const char* why) { return Fail(FaultKind::kUnauthenticated, why); }

// The scheme is the same in any case of its letters.
bool IsBearer(std::string_view scheme) {
  constexpr std::string_view kBearer = "bearer ";
  if (scheme.size() != kBearer.size()) return false;
  for (std::size_t i = 0; i < scheme.size(); ++i) {
    const char c =
        scheme[i] >= 'A' && scheme[i] <= 'Z' ? static_cast<char>(scheme[i] - 'A' + 'a') : scheme[i];
    if (c != kBearer[i]) return false;
  }
  return true;
}

// Nothing without the header; a fault when it is there twice.
Result<std::optional<std::string_view>> HeaderOf(const grpc::CallbackServerContext& context,
                                                 const char* name) {
  const auto [first, last] = context.client_metadata().equal_range(name);
  if (first == last) return std::optional<std::string_view>();
  if (std::next(first) != last) {
    return Fail(FaultKind::kUnauthenticated,
                "The header " + std::string(name) + " is there twice.");
  }
  return std::optional(View(first->second));
}

// Nothing without the header; a fault for one that is not a single bearer token.
Result<std::optional<std::string_view>> TokenOf(const grpc::CallbackServerContext& context) {
  constexpr std::size_t kScheme = std::string_view("Bearer ").size();
  TRY(const auto value, HeaderOf(context, kHeader));
  if (!value) return value;
  if (!IsBearer(value->substr(0, kScheme))) {
    return Refused("The header authorization is not of the form \"Bearer TOKEN\".");
  }
  return std::optional(value->substr(kScheme));
}

std::optional<std::string> CommonNameOf(const grpc::CallbackServerContext& context) {
  const auto auth = context.auth_context();
  if (!auth) return std::nullopt;
  const auto names = auth->FindPropertyValues(kCommonName);
  if (names.empty()) return std::nullopt;
  return std::string(View(names.front()));
}

// Who it is by token or certificate.
Result<app::Caller> Identify(const grpc::CallbackServerContext& context, const Identity& identity) {
  const auto token = TokenOf(context);
  if (!token) return Fail(token.error());
  TRY(const auto user, HeaderOf(context, kUserHeader));  // that a gateway speaks for
  if (*token) {
    if (!identity.tokens) return Refused("This server takes no bearer tokens.");
    return identity.tokens->Check(**token, user ? std::optional(std::string(*user)) : std::nullopt);
  }
  if (user) return Refused("The header x-arapd-owner needs the bearer token of a gateway.");
  if (auto name = CommonNameOf(context)) {
    if (!IsName(*name) || *name == app::kNobody) {
      return Refused("The common name of the client certificate is not a name of an owner.");
    }
    return app::Caller{*std::move(name), app::Role::kUser, identity.limits};
  }
  if (identity.demanded) {
    return Refused(identity.tokens
                       ? "This server wants to know who is calling: send a bearer token."
                       : "This server wants to know who is calling: use a client certificate.");
  }
  return app::Caller{app::kNobody, app::Role::kUser, identity.limits};
}

}  // namespace

Result<app::Caller> CallerOf(const grpc::CallbackServerContext& context, const Identity& identity) {
  auto caller = Identify(context, identity);
  // A gateway with a bad name for its user has an identity, too.
  const bool known = caller || caller.error().kind != FaultKind::kUnauthenticated;
  if (known && identity.connections != nullptr) identity.connections->Known(context.peer());
  return caller;
}

CallerWatch WatchCaller(const grpc::CallbackServerContext& context, const Identity& identity,
                        const app::Caller& caller, const std::function<void(Fault)>& lost) {
  CallerWatch watch;
  if (identity.connections != nullptr) {
    watch.age = identity.connections->WatchAge(context.peer(), lost);
  }
  const auto token = TokenOf(context);
  if (identity.tokens && token && *token) {
    watch.token = identity.tokens->Watch(app::TokenFile::IdOf(**token), caller.owner, lost);
  }
  return watch;
}

// "No deadline" reaches a server as one centuries off.
CancelToken CancelTokenOf(const grpc::CallbackServerContext* context) {
  return CancelToken([context]() -> Status {
    runtime::GiveWay();
    // The deadline first: when it passes, the call counts as cancelled too.
    if (std::chrono::system_clock::now() >= context->deadline()) {
      return Fail(FaultKind::kDeadlineExceeded, "The deadline has passed.");
    }
    if (context->IsCancelled()) return Fail(FaultKind::kCancelled, "The caller has cancelled.");
    return {};
  });
}

}  // namespace arap::rpc
