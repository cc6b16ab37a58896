// What becomes of statuses: the faults that they tell of.
#include "proto/convert/status.h"

#include <gmock/gmock.h>

#include "arap/v1/errors.pb.h"
#include "google/rpc/error_details.pb.h"

namespace arap::convert {
namespace {

using testing::ElementsAre;
using testing::Pair;

google::rpc::Status WithReason(int code, const std::string& reason) {
  google::rpc::Status status;
  status.set_code(code);
  status.set_message("something is wrong");
  google::rpc::ErrorInfo info;
  info.set_reason(reason);
  info.set_domain("arapd");
  status.add_details()->PackFrom(info);
  return status;
}

TEST(StatusToFault, EveryReasonHasItsOwnKind) {
  const google::protobuf::EnumDescriptor& reasons = *v1::ErrorReason_descriptor();
  std::map<FaultKind, std::string> seen;
  for (int i = 0; i < reasons.value_count(); ++i) {
    const std::string name = reasons.value(i)->name().substr(std::string("ERROR_REASON_").size());
    const std::optional<FaultKind> kind = KindOfReason(name);
    if (reasons.value(i)->number() == 0) {
      EXPECT_FALSE(kind);
      continue;
    }
    ASSERT_TRUE(kind) << name;
    EXPECT_TRUE(seen.emplace(*kind, name).second) << name << " and " << seen[*kind];
    // The kind's own name is the reason in lower case.
    std::string lower;
    for (const char c : name) lower += c == '_' ? c : static_cast<char>(c - 'A' + 'a');
    EXPECT_EQ(FaultName(*kind), lower);
  }
}

TEST(StatusToFault, ReadsReasonElementsFieldAndDelay) {
  google::rpc::Status status;
  status.set_code(grpc::StatusCode::INVALID_ARGUMENT);
  status.set_message("triangle 3 has no area");
  google::rpc::ErrorInfo info;
  info.set_reason("DEGENERATE_TRIANGLE");
  (*info.mutable_metadata())["elements"] = "3,17, 4294967295";
  (*info.mutable_metadata())["limit"] = "1e-12";
  (*info.mutable_metadata())["area"] = "0";
  status.add_details()->PackFrom(info);
  google::rpc::BadRequest bad_request;
  bad_request.add_field_violations()->set_field("mesh.triangles");
  status.add_details()->PackFrom(bad_request);
  google::rpc::RetryInfo retry;
  retry.mutable_retry_delay()->set_seconds(1);
  retry.mutable_retry_delay()->set_nanos(500'000'000);
  status.add_details()->PackFrom(retry);

  const Fault fault = FaultOf(status);
  EXPECT_EQ(fault.kind, FaultKind::kDegenerateTriangle);
  EXPECT_EQ(fault.message, "triangle 3 has no area");
  EXPECT_THAT(fault.elements, ElementsAre(3, 17, 4294967295u));
  EXPECT_EQ(fault.field, "mesh.triangles");
  EXPECT_THAT(fault.details,
              ElementsAre(Pair("area", "0"), Pair("limit", "1e-12"),
                          Pair("grpc_code", "INVALID_ARGUMENT"), Pair("retry_delay_ms", "1500")));
  EXPECT_EQ(DetailOf(fault, kGrpcCodeDetail), "INVALID_ARGUMENT");
  EXPECT_EQ(DetailOf(fault, "nothing"), "");
}

TEST(StatusToFault, ReadsTheDetailsOfACall) {
  const google::rpc::Status details = WithReason(grpc::StatusCode::NOT_FOUND, "UNKNOWN_HANDLE");
  const grpc::Status status(grpc::StatusCode::NOT_FOUND, "no handle x",
                            details.SerializeAsString());
  const Fault fault = FaultOf(status);
  EXPECT_EQ(fault.kind, FaultKind::kUnknownHandle);
  EXPECT_EQ(fault.message, "no handle x");
}

TEST(StatusToFault, WithoutAReasonTheCodeCounts) {
  const std::pair<grpc::StatusCode, FaultKind> cases[] = {
      {grpc::StatusCode::UNAVAILABLE, FaultKind::kDraining},
      {grpc::StatusCode::RESOURCE_EXHAUSTED, FaultKind::kOverloaded},
      {grpc::StatusCode::DEADLINE_EXCEEDED, FaultKind::kDeadlineExceeded},
      {grpc::StatusCode::CANCELLED, FaultKind::kCancelled},
      {grpc::StatusCode::UNIMPLEMENTED, FaultKind::kUnimplemented},
      {grpc::StatusCode::UNKNOWN, FaultKind::kInternal},
      {grpc::StatusCode::DATA_LOSS, FaultKind::kInternal},
  };
  for (const auto& [code, kind] : cases) {
    const Fault fault = FaultOf(grpc::Status(code, "gone"));
    EXPECT_EQ(fault.kind, kind) << CodeName(code);
    EXPECT_EQ(DetailOf(fault, kGrpcCodeDetail), CodeName(code));
  }
}

TEST(StatusToFault, AnUnknownReasonIsKeptAndTheCodeCounts) {
  const Fault fault = FaultOf(WithReason(grpc::StatusCode::UNAVAILABLE, "OUT_OF_COFFEE"));
  EXPECT_EQ(fault.kind, FaultKind::kDraining);
  EXPECT_EQ(DetailOf(fault, "reason"), "OUT_OF_COFFEE");
}

TEST(StatusToFault, BrokenDetailsDoNotHideTheMessage) {
  const Fault fault =
      FaultOf(grpc::Status(grpc::StatusCode::UNAVAILABLE, "gone", "\xff\xff not a message"));
  EXPECT_EQ(fault.kind, FaultKind::kDraining);
  EXPECT_EQ(fault.message, "gone");
}

// There and back.
TEST(StatusToFault, IsTheFaultThatBecameTheStatus) {
  for (const FaultInfo& info : FaultTable()) {
    const Fault sent = Fault(info.kind, "A sentence.").Field("handles[3]").Elements({3, 5});
    Fault got = FaultOf(ToGrpcStatus(sent));
    EXPECT_EQ(DetailOf(got, kGrpcCodeDetail), CodeName(static_cast<int>(info.code)));
    got.details.clear();
    EXPECT_EQ(got, sent) << info.reason;
  }
}

}  // namespace
}  // namespace arap::convert
