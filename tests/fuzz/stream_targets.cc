// The streams, over a channel within the process; and their rules alone.
#include <chrono>
#include <future>
#include <vector>

#include <google/rpc/status.pb.h>

#include "tests/fuzz/bytes.h"
#include "tests/fuzz/check.h"
#include "tests/fuzz/targets.h"
#include "tests/fuzz/world.h"
#include "tests/server/streams/policy_driver.h"

namespace arap::fuzz {
namespace {

constexpr int kMaxMessages = 24;

// Writes one message after the other and reads what comes, both at once.
class Conversation final
    : public grpc::ClientBidiReactor<v1::StreamDeformRequest, v1::StreamDeformResponse> {
 public:
  explicit Conversation(std::vector<v1::StreamDeformRequest> messages)
      : messages_(std::move(messages)) {
    context_.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(5));
    World::Get().deformation().async()->StreamDeform(&context_, this);
    StartRead(&response_);
    WriteNext();
    StartCall();
  }

  grpc::Status Await() { return status_.get_future().get(); }

 private:
  void WriteNext() {
    if (next_ < messages_.size()) {
      StartWrite(&messages_[next_++]);
    } else {
      StartWritesDone();
    }
  }
  void OnWriteDone(bool ok) override {
    if (ok) WriteNext();
  }
  void OnReadDone(bool ok) override {
    if (!ok) return;
    CheckFinite(response_);
    if (response_.has_error()) {
      Promise(!response_.error().status().message().empty(), "a fault has a message");
      const auto& fault = response_.error().status();
      Promise(!IsBug(fault.code(), fault.SerializeAsString()), "no input shows a bug",
              fault.message().c_str());
    }
    StartRead(&response_);
  }
  void OnDone(const grpc::Status& status) override { status_.set_value(status); }

  std::vector<v1::StreamDeformRequest> messages_;
  std::size_t next_ = 0;
  grpc::ClientContext context_;
  v1::StreamDeformResponse response_;
  std::promise<grpc::Status> status_;
};

}  // namespace

void Stream(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  std::vector<v1::StreamDeformRequest> messages;
  // Most inputs should get in: without this bit the first message is theirs too.
  const std::uint8_t flags = bytes.Byte();
  if ((flags & 1u) != 0) {
    auto& open = *messages.emplace_back().mutable_open();
    open.set_session_id(kSession);
    open.set_handle_set_id(kSet);
    open.set_delivery((flags & 2u) != 0 ? v1::DELIVERY_EVERY : v1::DELIVERY_LATEST);
    v1::DeformOptions& options = *open.mutable_options();
    options.set_refine(flags >> 2u & 3u);
    // 3 is an encoding too.
    options.set_encoding(static_cast<v1::PositionEncoding>(flags >> 4u & 3u));
    options.set_relative_to_origin((flags & 64u) != 0);
    options.set_boundary_only((flags & 128u) != 0);
  }
  while (!bytes.empty() && messages.size() < kMaxMessages) {
    const auto part = bytes.Part();
    if (!messages.emplace_back().ParseFromArray(part.data(), static_cast<int>(part.size()))) {
      messages.pop_back();
    }
  }
  Conversation conversation(std::move(messages));
  CheckEnd(conversation.Await());
  World::Get().Reset();
}

void Track(const std::uint8_t* data, std::size_t size) {
  v1::DeformTrackRequest request;
  if (!request.ParseFromArray(data, static_cast<int>(size))) return;
  if (request.session_id().empty()) request.set_session_id(kSession);
  if (request.handle_set_id().empty()) request.set_handle_set_id(kSet);
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(5));
  const auto reader = World::Get().deformation().DeformTrack(&context, request);
  v1::DeformTrackResponse response;
  while (reader->Read(&response)) CheckFinite(response);
  CheckEnd(reader->Finish());
}

void Policy(const std::uint8_t* data, std::size_t size) {
  const std::string broken = testing::DrivePolicy(data, size);
  Promise(broken.empty(), "a stream keeps its rules", broken.c_str());
}

}  // namespace arap::fuzz
