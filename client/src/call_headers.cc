#include "client/src/call_headers.h"

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

}  // namespace arap::client::internal
