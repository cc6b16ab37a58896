#include "client/src/calls.h"

#include <algorithm>
#include <charconv>
#include <condition_variable>
#include <mutex>
#include <random>
#include <string_view>
#include <utility>
#include <vector>

#include <grpcpp/client_context.h>

#include "core/base/names.h"

namespace arap::client::internal {
namespace {

constexpr std::size_t kTraceBytes = 16, kSpanBytes = 8;

// "00-TRACE-SPAN-FLAGS", as version 00 of the recommendation has it.
bool IsTraceparent(std::string_view text) {
  constexpr std::size_t kLength = 55;
  return text.size() == kLength && text.starts_with("00-") && IsHex(text.substr(3, 32), 32) &&
         text[35] == '-' && IsHex(text.substr(36, 16), 16) && text[52] == '-' &&
         IsHex(text.substr(53, 2), 2);
}

using std::chrono::milliseconds;
using std::chrono::steady_clock;
using std::chrono::system_clock;

constexpr milliseconds kLongestPause{2'000};

// What the server asks us to wait; 0 when it says nothing.
milliseconds DelayOf(const Fault& fault) {
  const std::string_view text = DetailOf(fault, kRetryDelayDetail);
  milliseconds::rep delay = 0;
  std::from_chars(text.data(), text.data() + text.size(), delay);
  return milliseconds(std::max<milliseconds::rep>(delay, 0));
}

// Whether the server itself says that it has not begun, and that trying again helps.
bool IsRefused(const Fault& fault) {
  return (fault.kind == FaultKind::kOverloaded || fault.kind == FaultKind::kDraining) &&
         !DetailOf(fault, kRetryDelayDetail).empty();
}

// Whether the fault is worth another attempt.
bool MayBeRepeated(Repeat repeat, const grpc::Status& status, const Fault& fault) {
  if (IsRefused(fault)) return true;
  return repeat != Repeat::kNever && IsLost(status);
}

// False when it is stopped meanwhile.
bool Wait(milliseconds pause, const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any never;
  std::unique_lock lock(mutex);
  never.wait_for(lock, stop, pause, [] { return false; });
  return !stop.stop_requested();
}

}  // namespace

std::string RandomHex(std::size_t bytes) {
  std::random_device random;
  std::vector<unsigned char> drawn(bytes);
  for (unsigned char& byte : drawn) byte = static_cast<unsigned char>(random());
  return Hex(drawn);
}

CallHeaders::CallHeaders(std::string session_id, std::string traceparent)
    : session_id_(std::move(session_id)),
      request_id_(RandomHex(kTraceBytes)),
      traceparent_(IsTraceparent(traceparent)
                       ? std::move(traceparent)
                       : "00-" + RandomHex(kTraceBytes) + "-" + RandomHex(kSpanBytes) + "-01") {}

void CallHeaders::AddTo(grpc::ClientContext& context) const {
  // A header cannot carry everything; the server refuses what is no name anyway.
  if (IsName(session_id_)) context.AddMetadata("x-session-id", session_id_);
  context.AddMetadata("x-request-id", request_id_);
  context.AddMetadata("traceparent", traceparent_);
}

bool IsLost(const grpc::Status& status) {
  const auto says = [&](std::string_view words) {
    return status.error_message().find(words) != std::string::npos;
  };
  switch (status.error_code()) {
    case grpc::StatusCode::UNAVAILABLE:
    case grpc::StatusCode::CANCELLED:  // a server that stops, haproxy
      return true;
    case grpc::StatusCode::UNKNOWN:
      return says("No status received") || says("Stream removed");  // the connection went
    case grpc::StatusCode::INTERNAL:
      return says("RST_STREAM");
    default:
      return false;
  }
}

bool IsFull(const Fault& fault) { return DetailOf(fault, kGrpcCodeDetail) == "RESOURCE_EXHAUSTED"; }

milliseconds Backoff::Next() {
  const milliseconds most = std::exchange(next_, std::min(2 * next_, kLongestPause));
  std::random_device random;
  std::uniform_int_distribution<milliseconds::rep> pause(most.count() / 2, most.count());
  return milliseconds(pause(random));
}

std::optional<system_clock::time_point> DeadlineOf(const CallOptions& call, milliseconds limit) {
  const milliseconds left = call.timeout.value_or(limit);
  // Beyond what a clock can say is for ever too.
  if (left >= std::chrono::hours(24 * 365)) return std::nullopt;
  return system_clock::now() + left;
}

void Attempt::Prepare(grpc::ClientContext& context) const {
  headers.AddTo(context);
  if (deadline) context.set_deadline(*deadline);
}

Status MakeCall(const Method& method, const CallOptions& call, const std::string& session_id,
                const std::function<grpc::Status(const Attempt&)>& attempt, const bool* heard) {
  const auto deadline = DeadlineOf(call, method.limit);
  const CallHeaders headers(session_id, call.traceparent);
  Backoff backoff;
  std::optional<steady_clock::time_point> give_up;  // from the first failure on, or the last piece
  bool in_doubt = false;                            // an attempt may have been carried out
  for (;;) {
    const grpc::Status status = attempt({headers, deadline, call.stop});
    if (status.ok()) return {};
    Fault fault = convert::FaultOf(status);
    if (in_doubt && method.repeat == Repeat::kRemoval && fault.kind == FaultKind::kNotFound) {
      return {};
    }
    fault.Detail(std::string(kRequestIdDetail), headers.request_id());
    if (call.stop.stop_requested() || !MayBeRepeated(method.repeat, status, fault)) {
      return Fail(std::move(fault));
    }
    in_doubt = in_doubt || !IsRefused(fault);
    const milliseconds pause = std::max(backoff.Next(), DelayOf(fault));
    const auto now = steady_clock::now();
    if (!give_up || (heard != nullptr && *heard)) give_up = now + call.retry_within;
    if (pause >= *give_up - now || (deadline && pause >= *deadline - system_clock::now()) ||
        !Wait(pause, call.stop)) {
      return Fail(std::move(fault));
    }
  }
}

}  // namespace arap::client::internal
