// What a DeformStream holds.
#pragma once

#include <memory>
#include <mutex>
#include <optional>

#include "client/src/channel.h"
#include "client/src/convert.h"

namespace arap::client {

class DeformStream::Impl {
 public:
  Impl(std::shared_ptr<internal::Channel> channel, const CallOptions& call,
       const std::string& session_id);
  ~Impl();

  // Sends the opening message and waits for its answer. Once, first.
  Status Open(const v1::OpenStream& open);
  Status Write(const v1::StreamDeformRequest& request);
  Status WritesDone();
  Result<std::optional<StreamEvent>> Read();
  void Cancel() { context_.TryCancel(); }

  const HandleSetInfo& handle_set() const { return handle_set_; }

 private:
  // The next message; empty when the server has ended the stream, and then `end_` is set.
  bool Next(v1::StreamDeformResponse& response);

  std::shared_ptr<internal::Channel> channel_;  // outlives the call
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReaderWriter<v1::StreamDeformRequest, v1::StreamDeformResponse>>
      stream_;
  HandleSetInfo handle_set_;  // set by Open, then constant

  std::mutex write_mutex_;  // one write in flight, and none once the call is finished
  bool sending_closed_ = false;
  bool finished_ = false;

  std::optional<Status> end_;  // how the stream ended; the reader's alone
};

}  // namespace arap::client
