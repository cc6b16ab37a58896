// MeshOutline over the wire and with the client library: what it answers, and what it refuses.
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "arap/client/client.h"
#include "tests/system/wire/wire_fixture.h"

namespace arap::wire {
namespace {

class MeshOutlineTest : public WireTest {
 protected:
  static void Add(const std::vector<double>& points, v1::MeshOutlineRequest* request) {
    request->add_outlines()->mutable_points()->Add(points.begin(), points.end());
  }

  static std::vector<double> Circle(double radius, int points) {
    std::vector<double> out;
    for (int i = 0; i < points; ++i) {
      const double angle = 2 * std::numbers::pi * i / points;
      out.insert(out.end(), {radius * std::cos(angle), radius * std::sin(angle)});
    }
    return out;
  }

  // A ring, about `vertices` of it.
  static v1::MeshOutlineRequest Ring(std::uint32_t vertices = 0) {
    v1::MeshOutlineRequest request;
    Add(Circle(10, 50), &request);
    Add(Circle(4, 25), &request);
    request.set_vertex_count(vertices);
    return request;
  }

  grpc::Status Mesh(const v1::MeshOutlineRequest& request, v1::MeshOutlineResponse* response) {
    return Call(&Deformation::MeshOutline, request, response);
  }
  grpc::Status Mesh(const v1::MeshOutlineRequest& request) {
    v1::MeshOutlineResponse response;
    return Mesh(request, &response);
  }
};

TEST_F(MeshOutlineTest, AnswersAMeshThatCanBeRegistered) {
  v1::MeshOutlineResponse response;
  ASSERT_TRUE(Mesh(Ring(), &response).ok());
  EXPECT_EQ(response.piece_count(), 1u);
  EXPECT_EQ(response.hole_count(), 1u);
  EXPECT_GE(response.smallest_angle_degrees(), 20);
  EXPECT_NEAR(response.mesh().vertices_size() / 2, 1000, 150);
  EXPECT_GT(response.solve_time().nanos(), 0);

  ASSERT_TRUE(CreateSession("s").ok());
  v1::RegisterMeshResponse registered;
  ASSERT_TRUE(Register("s", "m", response.mesh(), &registered).ok());
  EXPECT_EQ(registered.mesh().component_count(), 1u);
  EXPECT_EQ(registered.mesh().boundary_loop_count(), 2u);
  EXPECT_EQ(registered.mesh().warnings_size(), 0);

  v1::MeshOutlineResponse again;
  ASSERT_TRUE(Mesh(Ring(), &again).ok());
  EXPECT_EQ(again.mesh().SerializeAsString(), response.mesh().SerializeAsString());
  v1::MeshOutlineResponse fine;
  ASSERT_TRUE(Mesh(Ring(4000), &fine).ok());
  EXPECT_NEAR(fine.mesh().vertices_size() / 2, 4000, 600);
}

TEST_F(MeshOutlineTest, WhatIsWrongIsRefusedWithItsReason) {
  const auto of = [](const std::vector<std::vector<double>>& outlines) {
    v1::MeshOutlineRequest request;
    for (const auto& outline : outlines) Add(outline, &request);
    return request;
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  ExpectError(Mesh(of({})), grpc::INVALID_ARGUMENT, "EMPTY_MESH");
  ExpectError(Mesh(of({{0, 0, 1, 0, 0}})), grpc::INVALID_ARGUMENT, "ARRAY_LENGTH");
  ExpectError(Mesh(of({{0, 0, 1, 0}})), grpc::INVALID_ARGUMENT, "INVALID_OPTION");
  ExpectError(Mesh(of({{0, 0, 1, 1, 1, 0, 0, 1}})), grpc::INVALID_ARGUMENT, "INVALID_OPTION");
  ExpectError(Mesh(of({{0, 0, 1, kNan, 0, 1}})), grpc::INVALID_ARGUMENT, "NON_FINITE_COORDINATE");
  // A gap of a ten-millionth.
  ExpectError(Mesh(of({{0, 0, 9, 0, 9, 9, 0, 9}, {1e-6, 1, 8, 1, 8, 8, 1e-6, 8}})),
              grpc::RESOURCE_EXHAUSTED, "LIMIT_EXCEEDED");
}

TEST_F(MeshOutlineTest, TheLimitOfVerticesHolds) {
  options().limits.max_vertices = 60;
  ExpectError(Mesh(Ring()), grpc::RESOURCE_EXHAUSTED, "MESH_TOO_LARGE");  // 75 points
  v1::MeshOutlineRequest request;
  Add(Circle(10, 20), &request);
  request.set_vertex_count(61);
  const WireError error = ExpectError(Mesh(request), grpc::RESOURCE_EXHAUSTED, "LIMIT_EXCEEDED");
  EXPECT_EQ(error.fields, std::vector<std::string>{"vertex_count"});
  request.set_vertex_count(30);
  v1::MeshOutlineResponse response;
  ASSERT_TRUE(Mesh(request, &response).ok());
  EXPECT_LE(response.mesh().vertices_size(), 120);
}

TEST_F(MeshOutlineTest, TheClientLibraryAsksAndChecks) {
  const auto client = client::Client::Connect(host().addresses().front());
  client::Outline circle;
  const std::vector<double> numbers = Circle(10, 40);
  for (std::size_t i = 0; i < numbers.size(); i += 2) {
    circle.emplace_back(numbers[i], numbers[i + 1]);
  }
  const std::vector<client::Outline> outlines{circle};
  const auto answer = client.MeshOutline(outlines, 300);
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(answer->triangles.pieces, 1u);
  EXPECT_EQ(answer->triangles.holes, 0u);
  EXPECT_NEAR(static_cast<double>(answer->triangles.mesh.vertices.size()), 300, 45);
  const auto nothing = client.MeshOutline({});
  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error().kind, FaultKind::kEmptyMesh);
}

}  // namespace
}  // namespace arap::wire
