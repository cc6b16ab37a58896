#include "tests/system/fault/herd.h"

#include <atomic>
#include <mutex>

#include <gtest/gtest.h>

namespace arap::fault {

struct Herd::Tally {
  std::atomic<std::size_t> opened = 0;
  std::atomic<std::size_t> updates = 0;
  std::mutex mutex;
  std::map<grpc::StatusCode, std::size_t> ended;  // guarded by mutex
};

class Herd::Member final
    : public grpc::ClientBidiReactor<v1::StreamDeformRequest, v1::StreamDeformResponse> {
 public:
  Member(FaultClient& client, const HerdOptions& options, Tally& tally)
      : pushes_(options.habit == Habit::kPush), tally_(tally) {
    SetDeadline(context_, std::chrono::minutes(2));
    client.deformation().async()->StreamDeform(&context_, this);
    // A pusher does not even want to know how the stream was opened.
    if (!pushes_) StartRead(&response_);
    if (options.habit != Habit::kSilent) {
      request_.mutable_open()->set_session_id("s");
      request_.mutable_open()->set_handle_set_id("h");
      request_.mutable_open()->set_delivery(options.delivery);
      StartWrite(&request_);
    }
    StartCall();
  }

  void Cancel() { context_.TryCancel(); }

 private:
  void OnReadDone(bool ok) override {
    if (!ok) return;
    if (response_.has_opened()) ++tally_.opened;
    StartRead(&response_);
  }

  void OnWriteDone(bool ok) override {
    if (!ok || !pushes_) return;
    auto& update = *request_.mutable_update();
    if (update.sequence() > 0) ++tally_.updates;
    update.set_sequence(update.sequence() + 1);
    if (update.targets_size() == 0) update.add_targets()->set_handle_id("a");
    update.mutable_targets(0)->set_x(static_cast<double>(update.sequence() % 8));
    StartWrite(&request_);
  }

  void OnDone(const grpc::Status& status) override {
    const std::lock_guard lock(tally_.mutex);
    ++tally_.ended[status.error_code()];
  }

  const bool pushes_;
  Tally& tally_;
  grpc::ClientContext context_;
  v1::StreamDeformRequest request_;
  v1::StreamDeformResponse response_;
};

Herd::Herd(FaultClient& client, HerdOptions options)
    : client_(client), options_(options), tally_(std::make_unique<Tally>()) {}

// gRPC still writes to a member that has not ended: then there is nothing left but to wait.
Herd::~Herd() { EXPECT_TRUE(End(std::chrono::minutes(2))); }

void Herd::Open(std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    members_.push_back(std::make_unique<Member>(client_, options_, *tally_));
  }
}

std::size_t Herd::opened() const { return tally_->opened; }

std::size_t Herd::updates() const { return tally_->updates; }

std::size_t Herd::ended() const {
  const std::lock_guard lock(tally_->mutex);
  std::size_t sum = 0;
  for (const auto& [code, count] : tally_->ended) sum += count;
  return sum;
}

std::size_t Herd::ended(grpc::StatusCode code) const {
  const std::lock_guard lock(tally_->mutex);
  const auto found = tally_->ended.find(code);
  return found == tally_->ended.end() ? 0 : found->second;
}

bool Herd::End(std::chrono::milliseconds timeout) {
  for (const auto& member : members_) member->Cancel();
  return Eventually([this] { return ended() == members_.size(); }, timeout);
}

}  // namespace arap::fault
