// Handle sets over the wire: compilation, edits, every fault of a handle, quotas.
#include <limits>

#include "tests/system/wire/wire_fixture.h"

namespace arap::wire {
namespace {

class HandlesTest : public WireTest {
 protected:
  void SetUp() override {
    options().limits.max_handles = 4;
    options().limits.max_handle_sets_per_session = 2;
    SetUpCorners();
  }

  grpc::Status Edit(const std::vector<std::string>& remove, const std::vector<v1::Handle>& add,
                    v1::EditHandlesResponse* response = nullptr) {
    v1::EditHandlesRequest request;
    request.set_session_id("s");
    request.set_handle_set_id("h");
    request.mutable_remove()->Assign(remove.begin(), remove.end());
    request.mutable_add()->Assign(add.begin(), add.end());
    v1::EditHandlesResponse ignored;
    return Call(&Deformation::EditHandles, request, response ? response : &ignored);
  }

  v1::HandleSetInfo Get(const std::string& set) {
    v1::GetHandleSetRequest request;
    request.set_session_id("s");
    request.set_handle_set_id(set);
    v1::GetHandleSetResponse response;
    EXPECT_TRUE(Call(&Deformation::GetHandleSet, request, &response).ok());
    return response.handle_set();
  }

  // The error of compiling this handle as the second of a set.
  WireError CompileError(const v1::Handle& handle, const char* reason) {
    return ExpectError(Compile("s", "m", "bad", {VertexHandle("good", 0), handle}),
                       grpc::INVALID_ARGUMENT, reason);
  }

  static v1::Handle PointHandle(const std::string& id, double x, double y) {
    v1::Handle handle;
    handle.set_handle_id(id);
    handle.mutable_position()->set_x(x);
    handle.mutable_position()->set_y(y);
    return handle;
  }

  static v1::Handle TriangleHandle(const std::string& id, std::vector<double> weights) {
    v1::Handle handle;
    handle.set_handle_id(id);
    handle.mutable_triangle_point()->set_triangle(0);
    handle.mutable_triangle_point()->mutable_barycentric()->Assign(weights.begin(), weights.end());
    return handle;
  }
};

TEST_F(HandlesTest, CompileAnswersWhereTheHandlesAre) {
  v1::CompileHandlesResponse response;
  ASSERT_TRUE(Compile("s", "m", "all",
                      {VertexHandle("vertex", 6), PointHandle("point", 2.25, 3.5),
                       TriangleHandle("triangle", {0.25, 0.25, 0.5})},
                      &response)
                  .ok());
  const v1::HandleSetInfo& set = response.handle_set();
  EXPECT_EQ(set.handle_set_id(), "all");
  EXPECT_EQ(set.mesh_id(), "m");
  EXPECT_EQ(set.revision(), 1u);
  EXPECT_GE(set.row_count(), 3u);
  EXPECT_GT(set.bytes(), 0u);
  ASSERT_EQ(set.handles_size(), 3);
  EXPECT_EQ(set.handles(0).handle_id(), "vertex");
  EXPECT_NEAR(set.handles(0).rest().x(), 1, 1e-12);
  EXPECT_NEAR(set.handles(0).rest().y(), 1, 1e-12);
  EXPECT_NEAR(set.handles(1).rest().x(), 2.25, 1e-12);
  EXPECT_NEAR(set.handles(1).rest().y(), 3.5, 1e-12);
  EXPECT_NEAR(set.handles(2).rest().x(), 0.75, 1e-12);
  EXPECT_NEAR(set.handles(2).rest().y(), 0.5, 1e-12);
  EXPECT_EQ(Get("all").SerializeAsString(), set.SerializeAsString());
}

TEST_F(HandlesTest, RepeatingCompilationIsHarmlessAndIdsAreNotReused) {
  const std::vector<v1::Handle> handles = {VertexHandle("a", 0), VertexHandle("b", 4)};
  ASSERT_TRUE(Compile("s", "m", "again", handles).ok());
  EXPECT_TRUE(Compile("s", "m", "again", handles).ok());
  ExpectError(Compile("s", "m", "again", {VertexHandle("a", 0)}), grpc::ALREADY_EXISTS,
              "ALREADY_EXISTS");
}

TEST_F(HandlesTest, EmptySetIsASet) {
  ASSERT_TRUE(Compile("s", "m", "none", {}).ok());
  EXPECT_TRUE(Deform("s", "none", {}).ok());
}

TEST_F(HandlesTest, EditRemovesThenAdds) {
  v1::EditHandlesResponse response;
  ASSERT_TRUE(Edit({"b"}, {VertexHandle("b", 24), VertexHandle("d", 12)}, &response).ok());
  const v1::HandleSetInfo& set = response.handle_set();
  EXPECT_EQ(set.revision(), 2u);
  ASSERT_EQ(set.handles_size(), 4);
  EXPECT_EQ(set.handles(0).handle_id(), "a");
  EXPECT_EQ(set.handles(1).handle_id(), "c");
  EXPECT_EQ(set.handles(2).handle_id(), "b");
  EXPECT_NEAR(set.handles(2).rest().x(), 4, 1e-12);
  EXPECT_EQ(Get("h").SerializeAsString(), set.SerializeAsString());
}

TEST_F(HandlesTest, BadEditChangesNothing) {
  ExpectError(Edit({"nobody"}, {}), grpc::NOT_FOUND, "UNKNOWN_HANDLE");
  ExpectError(Edit({}, {VertexHandle("a", 7)}), grpc::INVALID_ARGUMENT, "DUPLICATE_HANDLE");
  auto error = ExpectError(Edit({"a"}, {VertexHandle("d", 99)}), grpc::INVALID_ARGUMENT,
                           "INDEX_OUT_OF_RANGE");
  EXPECT_EQ(error.fields, std::vector<std::string>{"add[0]"});
  error = ExpectError(Edit({}, {VertexHandle("d", 1), VertexHandle("e", 2)}),
                      grpc::RESOURCE_EXHAUSTED, "TOO_MANY_HANDLES");
  EXPECT_EQ(error.metadata.at("limit"), "4");
  EXPECT_EQ(Get("h").revision(), 1u);
  EXPECT_EQ(Get("h").handles_size(), 3);
}

TEST_F(HandlesTest, DeletedSetIsGone) {
  v1::DeleteHandleSetRequest request;
  request.set_session_id("s");
  request.set_handle_set_id("h");
  v1::DeleteHandleSetResponse response;
  ASSERT_TRUE(Call(&Deformation::DeleteHandleSet, request, &response).ok());
  ExpectError(Call(&Deformation::DeleteHandleSet, request, &response), grpc::NOT_FOUND,
              "NOT_FOUND");
  ExpectError(Edit({}, {}), grpc::NOT_FOUND, "NOT_FOUND");
}

TEST_F(HandlesTest, QuotasNameThemselves) {
  ASSERT_TRUE(Compile("s", "m", "second", {}).ok());
  auto error =
      ExpectError(Compile("s", "m", "third", {}), grpc::RESOURCE_EXHAUSTED, "LIMIT_EXCEEDED");
  EXPECT_EQ(error.metadata.at("quota"), "max_handle_sets_per_session");
  std::vector<v1::Handle> handles;
  for (std::uint32_t i = 0; i < 5; ++i) handles.push_back(VertexHandle("v" + std::to_string(i), i));
  error = ExpectError(Compile("s", "m", "large", handles), grpc::RESOURCE_EXHAUSTED,
                      "TOO_MANY_HANDLES");
  EXPECT_EQ(error.metadata.at("quota"), "max_handles");
  EXPECT_EQ(error.metadata.at("limit"), "4");
}

TEST_F(HandlesTest, UnknownMeshIsRefused) {
  ExpectError(Compile("s", "none", "x", {}), grpc::NOT_FOUND, "NOT_FOUND");
  ExpectError(Compile("s", "m", "a b", {}), grpc::INVALID_ARGUMENT, "INVALID_NAME");
}

TEST_F(HandlesTest, BadHandlesAreNamed) {
  auto error = CompileError(VertexHandle("x", 25), "INDEX_OUT_OF_RANGE");
  EXPECT_EQ(error.fields, std::vector<std::string>{"handles[1]"});
  CompileError(VertexHandle("good", 3), "DUPLICATE_HANDLE");
  error = CompileError(VertexHandle("no spaces", 3), "INVALID_NAME");
  EXPECT_EQ(error.fields, std::vector<std::string>{"handles[1].handle_id"});
  v1::Handle nowhere;
  nowhere.set_handle_id("x");
  error = CompileError(nowhere, "INVALID_OPTION");
  EXPECT_EQ(error.fields, std::vector<std::string>{"handles[1]"});
}

TEST_F(HandlesTest, HandleOutsideSaysHowFarAndCanBeSnapped) {
  v1::Handle outside = PointHandle("x", 5, 2);
  const auto error = CompileError(outside, "HANDLE_OUTSIDE");
  EXPECT_NEAR(std::stod(error.metadata.at("distance")), 1, 1e-6);
  outside.set_outside(v1::OUTSIDE_POLICY_SNAP);
  v1::CompileHandlesResponse response;
  ASSERT_TRUE(Compile("s", "m", "snapped", {outside}, &response).ok());
  EXPECT_NEAR(response.handle_set().handles(0).rest().x(), 4, 1e-9);
  EXPECT_NEAR(response.handle_set().handles(0).snapped_distance(), 1, 1e-9);
}

TEST_F(HandlesTest, BarycentricWeightsHaveRules) {
  const std::vector<std::string> field = {"handles[1].triangle_point.barycentric"};
  auto error = CompileError(TriangleHandle("x", {0.5, 0.5}), "ARRAY_LENGTH");
  EXPECT_EQ(error.fields, field);
  for (const auto& weights :
       std::vector<std::vector<double>>{{0.5, 0.5, 0.5},
                                        {-0.5, 0.5, 1},
                                        {2, -0.5, -0.5},
                                        {std::numeric_limits<double>::quiet_NaN(), 0.5, 0.5}}) {
    error = CompileError(TriangleHandle("x", weights), "INVALID_OPTION");
    EXPECT_EQ(error.fields, field);
  }
}

TEST_F(HandlesTest, NumbersOfAHandleHaveRanges) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [&](auto set, const char* field) {
    v1::Handle handle = VertexHandle("x", 3);
    set(handle);
    const auto error = CompileError(handle, "INVALID_OPTION");
    EXPECT_EQ(error.fields, std::vector<std::string>{std::string("handles[1].") + field});
  };
  for (const double bad : {0.0, -1.0, 2e12, nan}) {
    refused([&](v1::Handle& handle) { handle.set_weight(bad); }, "weight");
  }
  refused([&](v1::Handle& handle) { handle.set_area_radius(-1); }, "area_radius");
  refused([&](v1::Handle& handle) { handle.set_depth(nan); }, "depth");
  // A double, but no float.
  refused([&](v1::Handle& handle) { handle.set_depth(1e300); }, "depth");
  refused([&](v1::Handle& handle) { handle.set_depth_falloff(-1); }, "depth_falloff");
  refused([&](v1::Handle& handle) { handle.mutable_position()->set_x(nan); }, "position.x");
  refused([&](v1::Handle& handle) { handle.set_outside(static_cast<v1::OutsidePolicy>(9)); },
          "outside");
}

TEST_F(HandlesTest, DepthOrdersTheTriangles) {
  v1::Handle near = VertexHandle("near", 0);
  near.set_depth(1);
  v1::CompileHandlesResponse response;
  ASSERT_TRUE(Compile("s", "m", "deep", {near, VertexHandle("far", 24)}, &response).ok());
  EXPECT_EQ(response.handle_set().depth_size(), 25);
  EXPECT_EQ(response.handle_set().draw_order_size(), 32);
  EXPECT_EQ(Get("h").depth_size(), 0);
}

}  // namespace
}  // namespace arap::wire
