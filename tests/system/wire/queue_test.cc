// What callers of jobs are told of the queue: answers how they fared in it, refusals how they would
// have.
#include <cstdlib>
#include <future>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/bounded.h"
#include "tests/system/wire/wire_fixture.h"

namespace arap::wire {
namespace {

class QueueTest : public WireTest {
 protected:
  QueueTest() {
    options().lanes = {1, 1};
    options().limits.max_queued_jobs = 4;
    SetUpCorners();
  }

  runtime::WorkerPool& jobs() { return host().engine().jobs; }

  // What an answer told: place and wait, empty when it told nothing.
  using Told = std::pair<std::string, std::string>;
  static Told ToldBy(const grpc::ClientContext& context) {
    const auto value = [&](const char* name) {
      const auto& all = context.GetServerTrailingMetadata();
      const auto found = all.find(name);
      return found == all.end() ? std::string()
                                : std::string(found->second.data(), found->second.size());
    };
    return {value("x-arapd-queue-place"), value("x-arapd-queue-wait-ms")};
  }

  template <class Request, class Response>
  Told Ask(grpc::Status (Deformation::*method)(grpc::ClientContext*, const Request&, Response*),
           const Request& request) {
    grpc::ClientContext context;
    SetDeadline(context);
    Response response;
    const grpc::Status status = (deformation().*method)(&context, request, &response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return ToldBy(context);
  }

  static v1::RegisterMeshRequest MeshRequest(const std::string& mesh) {
    v1::RegisterMeshRequest request;
    request.set_session_id("s");
    request.set_mesh_id(mesh);
    *request.mutable_mesh() = Grid(2, 3);
    return request;
  }
};

TEST_F(QueueTest, AnswersTellHowTheyFared) {
  std::vector<std::future<Told>> answers;
  {
    PoolGate gate(jobs());
    for (const char* mesh : {"first", "second", "third"}) {
      const std::size_t waiting = jobs().waiting() + 1;
      answers.push_back(std::async(std::launch::async, [this, mesh] {
        return Ask(&Deformation::RegisterMesh, MeshRequest(mesh));
      }));
      ASSERT_TRUE(testing::Await("the call waits", [&] { return jobs().waiting() == waiting; }));
    }
  }
  for (std::size_t place = 0; place < answers.size(); ++place) {
    const auto [told, wait] = testing::Answer(answers[place], "an answer");
    EXPECT_EQ(told, std::to_string(place));
    char* end = nullptr;
    EXPECT_GE(std::strtod(wait.c_str(), &end), 0);
    EXPECT_TRUE(!wait.empty() && *end == 0) << wait;
  }
}

TEST_F(QueueTest, WhatDoesNotQueueTellsNothing) {
  v1::GetMeshRequest mesh;
  mesh.set_session_id("s");
  mesh.set_mesh_id("m");
  EXPECT_EQ(Ask(&Deformation::GetMesh, mesh), Told());
  v1::DeformRequest frame;
  frame.set_session_id("s");
  frame.set_handle_set_id("h");
  for (const auto& target : {TargetAt("a", 0, 0), TargetAt("b", 4, 0), TargetAt("c", 0, 4)}) {
    *frame.add_targets() = target;
  }
  EXPECT_EQ(Ask(&Deformation::Deform, frame), Told());
}

TEST_F(QueueTest, RefusalsTellHowTheyWouldHaveFared) {
  const PoolGate gate(jobs());
  std::size_t waiting = 0;
  while (jobs().TryPost([] {}, {app::kNobody, 0, 30})) ++waiting;
  grpc::ClientContext context;
  SetDeadline(context);
  v1::RegisterMeshResponse response;
  WireError error =
      ExpectError(deformation().RegisterMesh(&context, MeshRequest("more"), &response),
                  grpc::RESOURCE_EXHAUSTED, "OVERLOADED");
  EXPECT_EQ(error.metadata["place"], std::to_string(waiting));
  EXPECT_GE(std::atof(error.metadata["expected_wait_ms"].c_str()), 30'000);
  EXPECT_GE(error.retry_seconds, 30);
  EXPECT_EQ(ToldBy(context), Told());
}

}  // namespace
}  // namespace arap::wire
