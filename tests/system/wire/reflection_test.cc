// Reflection, as tools ask for it: every service that is listed has its descriptors, and so have
// the messages that errors hold.
#include <set>

#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/empty.pb.h>
#include <google/protobuf/unknown_field_set.h>
#include <google/rpc/error_details.pb.h>
#include <grpcpp/generic/generic_stub.h>

#include "tests/system/wire/wire_fixture.h"

namespace arap::wire {
namespace {

using google::protobuf::FileDescriptorProto;

// The numbers of grpc/reflection/v1alpha/reflection.proto. Its messages are gRPC's own and linked
// into it; a second copy of ours would clash with them.
constexpr int kAskFileWithSymbol = 4;
constexpr int kAskServices = 7;
constexpr int kAnswerFiles = 4;
constexpr int kAnswerServices = 6;

// A message of which only bytes are known.
class Raw {
 public:
  Raw() = default;
  explicit Raw(const std::string& bytes) { EXPECT_TRUE(message_.ParseFromString(bytes)); }

  void Add(int number, const std::string& bytes) {
    message_.GetReflection()->MutableUnknownFields(&message_)->AddLengthDelimited(number, bytes);
  }
  // All values of a field.
  std::vector<std::string> Get(int number) const {
    const auto& fields = message_.GetReflection()->GetUnknownFields(message_);
    std::vector<std::string> values;
    for (int i = 0; i < fields.field_count(); ++i) {
      if (fields.field(i).number() != number) continue;
      values.push_back(fields.field(i).length_delimited());
    }
    return values;
  }
  std::string Bytes() const { return message_.SerializeAsString(); }

 private:
  google::protobuf::Empty message_;
};

class ReflectionTest : public WireTest {
 protected:
  // One question, one answer.
  Raw Ask(const Raw& question) {
    const auto channel =
        grpc::CreateChannel(host().addresses().front(), grpc::InsecureChannelCredentials());
    grpc::GenericStub stub(channel);
    grpc::ClientContext context;
    SetDeadline(context);
    grpc::CompletionQueue queue;
    const auto call = stub.PrepareCall(
        &context, "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo", &queue);
    // The deadline of the call ends every step.
    const auto step = [&] {
      void* tag = nullptr;
      bool ok = false;
      return queue.Next(&tag, &ok) && ok;
    };
    call->StartCall(nullptr);
    EXPECT_TRUE(step());
    const grpc::Slice slice(question.Bytes());
    call->Write(grpc::ByteBuffer(&slice, 1), nullptr);
    EXPECT_TRUE(step());
    grpc::ByteBuffer buffer;
    call->Read(&buffer, nullptr);
    EXPECT_TRUE(step());
    call->WritesDone(nullptr);
    EXPECT_TRUE(step());
    grpc::Status status;
    call->Finish(&status, nullptr);
    EXPECT_TRUE(step());
    EXPECT_TRUE(status.ok()) << status.error_message();
    grpc::Slice answer;
    EXPECT_TRUE(buffer.DumpToSingleSlice(&answer).ok());
    return Raw(std::string(answer.begin(), answer.end()));
  }

  std::vector<std::string> Services() {
    Raw question;
    question.Add(kAskServices, "*");
    std::vector<std::string> names;
    for (const std::string& list : Ask(question).Get(kAnswerServices)) {
      for (const std::string& service : Raw(list).Get(1)) {
        for (const std::string& name : Raw(service).Get(1)) names.push_back(name);
      }
    }
    return names;
  }

  // The file with the symbol and those that it needs; none when there is no such symbol.
  std::vector<FileDescriptorProto> FilesOf(const std::string& symbol) {
    Raw question;
    question.Add(kAskFileWithSymbol, symbol);
    std::vector<FileDescriptorProto> files;
    for (const std::string& answer : Ask(question).Get(kAnswerFiles)) {
      for (const std::string& bytes : Raw(answer).Get(1)) {
        EXPECT_TRUE(files.emplace_back().ParseFromString(bytes));
      }
    }
    return files;
  }
};

TEST_F(ReflectionTest, EveryServiceHasItsDescriptor) {
  const std::vector<std::string> services = Services();
  const std::set<std::string> known(services.begin(), services.end());
  for (const char* name : {"arap.v1.DeformationService", "arap.v1.FlatteningService",
                           "arap.v1.ServerService", "grpc.health.v1.Health"}) {
    EXPECT_TRUE(known.contains(name)) << name;
  }
  for (const std::string& service : services) {
    EXPECT_FALSE(FilesOf(service).empty()) << service;
  }
}

TEST_F(ReflectionTest, ErrorDetailsHaveTheirs) {
  for (const char* name : {"google.rpc.Status", "google.rpc.ErrorInfo", "google.rpc.BadRequest",
                           "google.rpc.RetryInfo"}) {
    EXPECT_FALSE(FilesOf(name).empty()) << name;
  }
}

// As googleapis publishes them: a trimmed copy under the same name cannot be used beside theirs.
TEST(ErrorDetails, AreTheOfficialOnes) {
  const auto& file = *google::rpc::ErrorInfo::descriptor()->file();
  EXPECT_EQ(file.name(), "google/rpc/error_details.proto");
  EXPECT_EQ(file.options().java_package(), "com.google.rpc");
  EXPECT_EQ(file.options().go_package(),
            "google.golang.org/genproto/googleapis/rpc/errdetails;errdetails");
  const std::map<std::string, std::vector<std::string>> expected{
      {"ErrorInfo", {"reason", "domain", "metadata"}},
      {"RetryInfo", {"retry_delay"}},
      {"DebugInfo", {"stack_entries", "detail"}},
      {"QuotaFailure", {"violations"}},
      {"PreconditionFailure", {"violations"}},
      {"BadRequest", {"field_violations"}},
      {"RequestInfo", {"request_id", "serving_data"}},
      {"ResourceInfo", {"resource_type", "resource_name", "owner", "description"}},
      {"Help", {"links"}},
      {"LocalizedMessage", {"locale", "message"}},
  };
  ASSERT_EQ(file.message_type_count(), static_cast<int>(expected.size()));
  for (const auto& [name, fields] : expected) {
    const auto* message = file.FindMessageTypeByName(name);
    ASSERT_NE(message, nullptr) << name;
    ASSERT_EQ(message->field_count(), static_cast<int>(fields.size())) << name;
    for (int i = 0; i < message->field_count(); ++i) {
      EXPECT_EQ(message->field(i)->name(), fields[static_cast<std::size_t>(i)]) << name;
      EXPECT_EQ(message->field(i)->number(), i + 1) << name;
    }
  }
}

}  // namespace
}  // namespace arap::wire
