// MeshOutline over the wire and with the client library: what it answers, and what it refuses.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <string>
#include <utility>
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

// From a point to the nearest of the closed curve x y x y….
double Away(Complex p, const std::vector<double>& outline) {
  double away = std::numeric_limits<double>::infinity();
  const auto at = [&](std::size_t i) {
    const std::size_t n = outline.size();
    return Complex(outline[i % n], outline[(i + 1) % n]);
  };
  for (std::size_t i = 0; i < outline.size(); i += 2) {
    const Complex a = at(i), along = at(i + 2) - a;
    const double t = (std::conj(along) * (p - a)).real() / std::norm(along);
    away = std::min(away, std::abs(p - a - std::clamp(t, 0.0, 1.0) * along));
  }
  return away;
}

// The points of the border of the mesh.
std::vector<Complex> BorderOf(const v1::PlanarMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (int t = 0; t < mesh.triangles_size(); t += 3) {
    for (int k = 0; k < 3; ++k) {
      ++edges[std::minmax(mesh.triangles(t + k), mesh.triangles(t + (k + 1) % 3))];
    }
  }
  std::vector<Complex> points;
  for (const auto& [edge, count] : edges) {
    if (count != 1) continue;
    const auto at = [&](std::uint32_t v) {
      return Complex(mesh.vertices(2 * static_cast<int>(v)),
                     mesh.vertices(2 * static_cast<int>(v) + 1));
    };
    constexpr int kSteps = 8;
    for (int i = 0; i < kSteps; ++i) {
      points.push_back(at(edge.first) +
                       static_cast<double>(i) / kSteps * (at(edge.second) - at(edge.first)));
    }
  }
  return points;
}

constexpr double kNineDigits = 1e-7;

TEST_F(MeshOutlineTest, SimplifiedItStaysWithinTheErrorThatIsTold) {
  const std::vector<double> circle = Circle(10, 2000);
  v1::MeshOutlineRequest request;
  Add(circle, &request);
  request.set_vertex_count(100);
  v1::MeshOutlineResponse whole;
  ASSERT_TRUE(Mesh(request, &whole).ok());
  EXPECT_EQ(whole.outline_error(), 0);
  EXPECT_GE(whole.mesh().vertices_size() / 2, 2000);

  request.set_tolerance(0.05);
  v1::MeshOutlineResponse simple;
  ASSERT_TRUE(Mesh(request, &simple).ok());
  EXPECT_EQ(simple.outline_error(), 0.05);
  EXPECT_LT(simple.mesh().vertices_size() / 2, 200);
  double worst = 0;
  const std::vector<Complex> border = BorderOf(simple.mesh());
  for (const Complex p : border) worst = std::max(worst, Away(p, circle));
  EXPECT_LE(worst, simple.outline_error() + kNineDigits);
  EXPECT_GT(worst, 0.01);  // it has made use of it
  // The other way round: what is made of it is dense, so its points stand for it.
  for (std::size_t i = 0; i < circle.size(); i += 2) {
    double away = std::numeric_limits<double>::infinity();
    for (const Complex p : border) {
      away = std::min(away, std::abs(p - Complex(circle[i], circle[i + 1])));
    }
    EXPECT_LE(away, simple.outline_error() + 0.2) << i;
  }

  v1::MeshOutlineResponse again;
  ASSERT_TRUE(Mesh(request, &again).ok());
  EXPECT_EQ(again.mesh().SerializeAsString(), simple.mesh().SerializeAsString());
}

TEST_F(MeshOutlineTest, WhatGrowsIsAsFarAsItWasAsked) {
  // A ring of squares with a narrow bay: corners that become arcs, a hole, a hollow corner.
  const std::vector<double> outside{0, 0, 20, 0, 20, 20, 11, 20, 11, 12, 9, 12, 9, 20, 0, 20};
  const std::vector<double> hole{3, 3, 3, 9, 9, 9, 9, 3};
  for (const double tolerance : {0.0, 0.1}) {
    for (const double far : {0.0, 5.4e6}) {
      SCOPED_TRACE(std::to_string(tolerance) + ", " + std::to_string(far));
      v1::MeshOutlineRequest request;
      for (std::vector<double> points : {outside, hole}) {
        for (double& x : points) x += far;
        Add(points, &request);
      }
      request.set_tolerance(tolerance);
      request.set_expansion(2);
      v1::MeshOutlineResponse response;
      ASSERT_TRUE(Mesh(request, &response).ok());
      EXPECT_EQ(response.piece_count(), 1u);
      EXPECT_EQ(response.hole_count(), 1u);  // the bay is as wide as that: it closes
      EXPECT_GT(response.outline_error(), 0);
      EXPECT_LT(response.outline_error(), tolerance == 0 ? 0.03 : 0.11);
      double low = 1e9, high = 0;
      for (const Complex p : BorderOf(response.mesh())) {
        const Complex q = p - Complex(far, far);
        const double away = std::min(Away(q, outside), Away(q, hole));
        low = std::min(low, away);
        high = std::max(high, away);
      }
      const double rounded = far == 0 ? kNineDigits : 1e-6;
      EXPECT_GE(low, 2 - response.outline_error() - rounded);
      EXPECT_LE(high, 2 + response.outline_error() + rounded);
      v1::MeshOutlineResponse again;
      ASSERT_TRUE(Mesh(request, &again).ok());
      EXPECT_EQ(again.mesh().SerializeAsString(), response.mesh().SerializeAsString());
    }
  }
}

TEST_F(MeshOutlineTest, WhatWouldTouchItselfGrowsALittleMore) {
  // Squares whose corners come to touch, and sides that come to lie on one another.
  for (const double across : {0.0, 3.0}) {
    v1::MeshOutlineRequest request;
    Add({0, 0, 2, 0, 2, 2, 0, 2}, &request);
    Add({6, across, 8, across, 8, across + 2, 6, across + 2}, &request);
    request.set_expansion(across == 0 ? 2 : std::hypot(4, 1) / 2);
    request.set_vertex_count(100);
    v1::MeshOutlineResponse response;
    ASSERT_TRUE(Mesh(request, &response).ok()) << across;
    EXPECT_LE(response.piece_count(), 2u);
    EXPECT_LT(response.outline_error(), 0.03);
  }
}

TEST_F(MeshOutlineTest, WhatCannotBeShapedIsRefusedWithTheFieldAndTheLimit) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const auto ask = [&](double tolerance, double expansion) {
    v1::MeshOutlineRequest request = Ring();
    request.set_tolerance(tolerance);
    request.set_expansion(expansion);
    return request;
  };
  for (const double wrong : {-1.0, kNan, std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(ExpectError(Mesh(ask(wrong, 0)), grpc::INVALID_ARGUMENT, "INVALID_OPTION").fields,
              std::vector<std::string>{"tolerance"});
    EXPECT_EQ(ExpectError(Mesh(ask(0, wrong)), grpc::INVALID_ARGUMENT, "INVALID_OPTION").fields,
              std::vector<std::string>{"expansion"});
  }
  EXPECT_EQ(ExpectError(Mesh(ask(0, 29)), grpc::INVALID_ARGUMENT, "INVALID_OPTION").fields,
            std::vector<std::string>{"expansion"});  // their box is 20 × 20
  EXPECT_TRUE(Mesh(ask(100, 0)).ok());               // as simple as can be, and still a ring

  v1::MeshOutlineRequest crossing;
  Add({0, 0, 1, 1, 1, 0, 0, 1}, &crossing);
  crossing.set_tolerance(0.1);
  EXPECT_EQ(ExpectError(Mesh(crossing), grpc::INVALID_ARGUMENT, "INVALID_OPTION").fields,
            std::vector<std::string>{"outlines"});
  crossing.set_expansion(0.1);
  ExpectError(Mesh(crossing), grpc::INVALID_ARGUMENT, "INVALID_OPTION");

  // More points than may grow; simplified they may.
  v1::MeshOutlineRequest many;
  Add(Circle(10, 20'001), &many);
  many.set_expansion(1);
  EXPECT_EQ(ExpectError(Mesh(many), grpc::RESOURCE_EXHAUSTED, "LIMIT_EXCEEDED").fields,
            std::vector<std::string>{"expansion"});
  many.set_tolerance(0.01);
  EXPECT_TRUE(Mesh(many).ok());

  // A comb whose teeth are far narrower than they grow: all arcs cross all others.
  v1::MeshOutlineRequest comb;
  std::vector<double> teeth;
  constexpr int kTeeth = 2000;
  for (int i = 0; i < kTeeth; ++i) {
    const double x = 0.005 * i;
    teeth.insert(teeth.end(), {x, 5.0 + 0.001 * (i % 7), x + 0.0025, 0.001 * (i % 5)});
  }
  teeth.insert(teeth.end(), {0.005 * kTeeth, -1, 0, -1});
  Add(teeth, &comb);
  comb.set_expansion(3);
  EXPECT_EQ(ExpectError(Mesh(comb), grpc::RESOURCE_EXHAUSTED, "LIMIT_EXCEEDED").fields,
            std::vector<std::string>{"expansion"});
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
  const auto answer = client.MeshOutline(outlines, {.vertices = 300});
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(answer->triangles.pieces, 1u);
  EXPECT_EQ(answer->triangles.holes, 0u);
  EXPECT_NEAR(static_cast<double>(answer->triangles.mesh.vertices.size()), 300, 45);
  EXPECT_EQ(answer->triangles.outline_error, 0);
  const auto grown =
      client.MeshOutline(outlines, {.vertices = 300, .tolerance = 0.1, .expansion = 5});
  ASSERT_TRUE(grown) << grown.error().message;
  EXPECT_NEAR(grown->triangles.outline_error, 0.1, 0.001);
  double radius = 0;
  for (const client::Complex p : grown->triangles.mesh.vertices) {
    radius = std::max(radius, std::abs(p));
  }
  EXPECT_NEAR(radius, 15, grown->triangles.outline_error);
  const auto nothing = client.MeshOutline({});
  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error().kind, FaultKind::kEmptyMesh);
}

}  // namespace
}  // namespace arap::wire
