// Every fault has its place on the wire.
#include <set>

#include <arap/v1/errors.pb.h>

#include "proto/convert/status.h"
#include "tests/system/wire/wire_fixture.h"

namespace arap::rpc {
namespace {

constexpr int kKinds = static_cast<int>(FaultKind::kInternal) + 1;

TEST(FaultToStatusTest, EveryKindHasItsOwnReasonOfTheInterface) {
  const auto* reasons = v1::ErrorReason_descriptor();
  std::set<std::string> used;
  for (int i = 0; i < kKinds; ++i) {
    const auto kind = static_cast<FaultKind>(i);
    const std::string name = "ERROR_REASON_" + std::string(InfoOf(kind).reason);
    EXPECT_NE(reasons->FindValueByName(name), nullptr) << name;
    EXPECT_TRUE(used.insert(name).second) << name;
  }
  // ERROR_REASON_UNSPECIFIED is the one that is never sent.
  EXPECT_EQ(static_cast<int>(used.size()), reasons->value_count() - 1);
}

TEST(FaultToStatusTest, ReasonIsTheNameOfTheFault) {
  for (int i = 0; i < kKinds; ++i) {
    std::string name = FaultName(static_cast<FaultKind>(i));
    for (char& c : name) c = c == '_' ? c : static_cast<char>(c - 'a' + 'A');
    EXPECT_EQ(name, InfoOf(static_cast<FaultKind>(i)).reason);
  }
}

TEST(FaultToStatusTest, DetailsTellEverything) {
  Fault fault = Fault(FaultKind::kDegenerateTriangle, "Triangle 7 has no area.")
                    .Field("triangles")
                    .Elements({7, 9});
  fault.Detail("limit", "1e-9");
  const grpc::Status status = convert::ToGrpcStatus(fault);
  const wire::WireError error =
      wire::ExpectError(status, grpc::INVALID_ARGUMENT, "DEGENERATE_TRIANGLE");
  EXPECT_EQ(error.message, "Triangle 7 has no area.");
  EXPECT_EQ(error.metadata.at("elements"), "7,9");
  EXPECT_EQ(error.metadata.at("limit"), "1e-9");
  EXPECT_EQ(error.fields, std::vector<std::string>{"triangles"});
  const wire::WireError in_stream =
      wire::ExpectError(convert::ToRpcStatus(fault), grpc::INVALID_ARGUMENT, "DEGENERATE_TRIANGLE");
  EXPECT_EQ(in_stream.metadata, error.metadata);
  EXPECT_EQ(in_stream.fields, error.fields);
}

TEST(FaultToStatusTest, OnlyWhatPassesIsToBeRetried) {
  for (int i = 0; i < kKinds; ++i) {
    const auto kind = static_cast<FaultKind>(i);
    const wire::WireError error = wire::Decode(convert::ToGrpcStatus({kind, "A sentence."}));
    const bool passes = error.code == grpc::RESOURCE_EXHAUSTED || error.code == grpc::UNAVAILABLE;
    EXPECT_EQ(error.retry_seconds > 0, passes) << FaultName(kind);
    EXPECT_NE(error.code, grpc::OK);
    EXPECT_NE(error.code, grpc::UNKNOWN);
    const Fault of_the_request = Fault(kind, "A sentence.").Field("mesh.triangles");
    EXPECT_EQ(wire::Decode(convert::ToGrpcStatus(of_the_request)).retry_seconds, passes ? 3'600 : 0)
        << FaultName(kind);
  }
}

TEST(FaultToStatusTest, LongTextsAreCutBetweenCharacters) {
  std::string text;
  while (text.size() < 100'000) text += "ä";
  Fault fault = Fault(FaultKind::kUnknownHandle, "x" + text).Field(text);
  for (int i = 0; i < 100; ++i) fault.Detail("detail" + std::to_string(i), text);
  const grpc::Status status = convert::ToGrpcStatus(fault);
  EXPECT_LT(status.error_message().size() + status.error_details().size(), 5'000u);
  EXPECT_TRUE(status.error_message().ends_with("ä..."));
}

}  // namespace
}  // namespace arap::rpc
