// What stands in the bytes of a shape: a client may declare `positions` as bytes, because they are one
// packed run.
#include <cstring>

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/wire_format_lite.h>
#include <grpcpp/generic/generic_stub.h>

#include "tests/system/wire/wire_fixture.h"

namespace arap::wire::packed {
namespace {

using google::protobuf::internal::WireFormatLite;

grpc::ByteBuffer BufferOf(const google::protobuf::Message& message) {
  const grpc::Slice slice(message.SerializeAsString());
  return {&slice, 1};
}

std::string BytesOf(const grpc::ByteBuffer& buffer) {
  grpc::Slice slice;
  if (!buffer.DumpToSingleSlice(&slice).ok()) return {};
  return {reinterpret_cast<const char*>(slice.begin()), slice.size()};
}

// A call whose messages are bytes. One thing happens at a time.
class RawCall {
 public:
  RawCall(const std::shared_ptr<grpc::Channel>& channel, const std::string& method)
      : stub_(channel) {
    context_.set_deadline(std::chrono::system_clock::now() + std::chrono::minutes(2));
    call_ = stub_.PrepareCall(&context_, "/arap.v1.DeformationService/" + method, &queue_);
    call_->StartCall(this);
    Wait();
  }

  void Send(const google::protobuf::Message& message, bool last) {
    call_->Write(BufferOf(message), this);
    Wait();
    if (!last) return;
    call_->WritesDone(this);
    Wait();
  }
  std::string Read() {
    grpc::ByteBuffer buffer;
    call_->Read(&buffer, this);
    return Wait() ? BytesOf(buffer) : std::string();
  }
  grpc::Status Finish() {
    grpc::Status status;
    call_->Finish(&status, this);
    Wait();
    return status;
  }

 private:
  bool Wait() {
    void* tag = nullptr;
    bool ok = false;
    return queue_.Next(&tag, &ok) && ok;
  }

  grpc::GenericStub stub_;
  grpc::ClientContext context_;
  grpc::CompletionQueue queue_;
  std::unique_ptr<grpc::GenericClientAsyncReaderWriter> call_;
};

// The content of every occurrence of a field in a message; those that are not of wire type LEN count
// as "not LEN".
std::vector<std::string> Occurrences(const std::string& message, int field) {
  google::protobuf::io::CodedInputStream in(reinterpret_cast<const std::uint8_t*>(message.data()),
                                            static_cast<int>(message.size()));
  std::vector<std::string> found;
  while (const std::uint32_t tag = in.ReadTag()) {
    if (WireFormatLite::GetTagFieldNumber(tag) != field) {
      if (!WireFormatLite::SkipField(&in, tag)) break;
      continue;
    }
    std::uint32_t size = 0;
    std::string content;
    const bool run =
        WireFormatLite::GetTagWireType(tag) == WireFormatLite::WIRETYPE_LENGTH_DELIMITED &&
        in.ReadVarint32(&size) && in.ReadString(&content, static_cast<int>(size));
    found.push_back(run ? content : "not LEN");
    if (!run) break;
  }
  return found;
}

class PackedRunTest : public WireTest {
 protected:
  void SetUp() override {
    SetUpCorners();
    channel_ = grpc::CreateChannel(host().addresses().front(), grpc::InsecureChannelCredentials());
  }

  template <class Request>
  static Request Of() {
    Request request;
    request.set_session_id("s");
    request.set_handle_set_id("h");
    return request;
  }

  // That the bytes of a message, with the shape in `field`, have the positions in one piece.
  static void ExpectRun(const std::string& message, int field) {
    const auto shapes = Occurrences(message, field);
    ASSERT_EQ(shapes.size(), 1u);
    v1::Shape shape;
    ASSERT_TRUE(shape.ParseFromString(shapes[0]));
    const auto runs = Occurrences(shapes[0], v1::Shape::kPositionsFieldNumber);
    ASSERT_EQ(runs.size(), 1u);
    ASSERT_EQ(runs[0].size(), 25 * 2 * sizeof(float));
    EXPECT_EQ(std::memcmp(runs[0].data(), shape.positions().data(), runs[0].size()), 0);
  }

  std::shared_ptr<grpc::Channel> channel_;
};

TEST_F(PackedRunTest, OfDeform) {
  auto request = Of<v1::DeformRequest>();
  for (const auto& target : {TargetAt("a", 1, 0), TargetAt("b", 4, 1), TargetAt("c", 0, 5)}) {
    *request.add_targets() = target;
  }
  RawCall call(channel_, "Deform");
  call.Send(request, true);
  ExpectRun(call.Read(), v1::DeformResponse::kShapeFieldNumber);
  EXPECT_TRUE(call.Finish().ok());
}

TEST_F(PackedRunTest, OfDeformTrack) {
  auto request = Of<v1::DeformTrackRequest>();
  for (const char* id : {"a", "b", "c"}) request.add_handle_ids(id);
  for (int i = 0; i < 3; ++i) {
    v1::TrackFrame& frame = *request.add_frames();
    for (const double x : {0.5 * i, 0.0, 4.0, 1.0, 0.0, 5.0}) frame.add_positions(x);
  }
  RawCall call(channel_, "DeformTrack");
  call.Send(request, true);
  for (int i = 0; i < 3; ++i) ExpectRun(call.Read(), v1::DeformTrackResponse::kShapeFieldNumber);
  EXPECT_TRUE(call.Finish().ok());
}

TEST_F(PackedRunTest, OfStreamDeform) {
  RawCall call(channel_, "StreamDeform");
  v1::StreamDeformRequest request;
  *request.mutable_open() = Of<v1::OpenStream>();
  call.Send(request, false);
  EXPECT_EQ(Occurrences(call.Read(), v1::StreamDeformResponse::kOpenedFieldNumber).size(), 1u);
  request.mutable_update()->set_sequence(1);
  *request.mutable_update()->add_targets() = TargetAt("b", 4, 1);
  call.Send(request, true);
  ExpectRun(call.Read(), v1::StreamDeformResponse::kShapeFieldNumber);
  EXPECT_TRUE(call.Finish().ok());
}

}  // namespace
}  // namespace arap::wire::packed
