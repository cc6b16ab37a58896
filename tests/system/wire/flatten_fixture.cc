#include "tests/system/wire/flatten_fixture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <utility>

#include "tests/support/compare.h"

namespace arap::wire {
namespace {

using Segment = std::array<std::uint32_t, 2>;

// The triangles of the answer by flat positions, their corners as in the request.
std::vector<Triangle> FlatTriangles(const v1::FlattenResponse& response) {
  std::vector<Triangle> triangles;
  for (int i = 0; i + 2 < response.corner_uv_size(); i += 3) {
    triangles.push_back(
        {response.corner_uv(i), response.corner_uv(i + 1), response.corner_uv(i + 2)});
  }
  return triangles;
}

// Segments of one triangle only, by their ends in order; as that triangle runs along them.
std::map<Segment, Segment> BoundaryOf(const std::vector<Triangle>& triangles) {
  std::map<Segment, std::vector<Segment>> uses;
  for (const Triangle& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Segment segment{t[k], t[(k + 1) % 3]};
      uses[{std::min(segment[0], segment[1]), std::max(segment[0], segment[1])}].push_back(segment);
    }
  }
  std::map<Segment, Segment> boundary;
  for (const auto& [ends, runs] : uses) {
    EXPECT_LE(runs.size(), 2u) << "a layout is manifold";
    if (runs.size() == 1) boundary[ends] = runs.front();
  }
  return boundary;
}

// `turned`: the winding of some triangles was repaired, and their corners run the other way.
void ExpectLoops(const v1::FlattenResponse& response, const std::vector<Triangle>& triangles,
                 bool turned) {
  std::map<Segment, Segment> left = BoundaryOf(triangles);
  for (const v1::FlatChart& chart : response.charts()) {
    for (const v1::FlatLoop& loop : chart.loops()) {
      const int n = loop.uv_indices_size();
      EXPECT_GE(n, 3);
      for (int i = 0; i < n; ++i) {
        const Segment run{loop.uv_indices(i), loop.uv_indices((i + 1) % n)};
        const auto found = left.find({std::min(run[0], run[1]), std::max(run[0], run[1])});
        ASSERT_NE(found, left.end()) << run[0] << "-" << run[1] << " is no boundary, or twice";
        if (!turned) {
          EXPECT_EQ(found->second, run) << "the surface is on the left";
        }
        left.erase(found);
      }
    }
  }
  EXPECT_TRUE(left.empty()) << left.size() << " boundary segments are in no loop";
}

}  // namespace

v1::FlattenRequest RequestFor(const SurfaceMesh& mesh) {
  v1::FlattenRequest request;
  for (const auto& vertex : mesh.vertices) {
    for (const double value : vertex) request.mutable_mesh()->add_vertices(value);
  }
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle) request.mutable_mesh()->add_triangles(v);
  }
  return request;
}

SurfaceMesh BentStrip() {
  constexpr std::uint32_t kFacets = 6;
  constexpr double kBend = 0.3;
  SurfaceMesh mesh;
  double x = 0;
  double z = 0;
  for (std::uint32_t i = 0; i <= kFacets; ++i) {
    for (const double y : {0.0, 2.0}) mesh.vertices.push_back({x, y, z});
    x += std::cos(kBend * i);
    z += std::sin(kBend * i);
  }
  for (std::uint32_t v = 0; v < 2 * kFacets; v += 2) {
    mesh.triangles.push_back({v, v + 2, v + 1});
    mesh.triangles.push_back({v + 1, v + 2, v + 3});
  }
  return mesh;
}

SurfaceMesh Fan() {
  return {{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, -1, 0}},
          {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}};
}

SurfaceMesh Bowtie() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}, {{0, 1, 2}, {0, 3, 4}}};
}

std::vector<Complex> Positions(const v1::FlattenResponse& response) {
  std::vector<Complex> points;
  for (int i = 0; i + 1 < response.uv_size(); i += 2) {
    points.emplace_back(response.uv(i), response.uv(i + 1));
  }
  for (int i = 0; i + 1 < response.uv64_size(); i += 2) {
    points.emplace_back(response.uv64(i), response.uv64(i + 1));
  }
  return points;
}

void ExpectConsistent(const v1::FlattenRequest& request, const v1::FlattenResponse& response) {
  const int vertices = request.mesh().vertices_size() / 3;
  const int triangles = request.mesh().triangles_size() / 3;
  const std::vector<Complex> uv = Positions(response);
  EXPECT_TRUE(testing::AllFinite(uv));
  ASSERT_EQ(response.uv_vertex_size(), static_cast<int>(uv.size()));
  ASSERT_GE(response.uv_vertex_size(), vertices);
  for (int i = 0; i < vertices; ++i) {
    EXPECT_EQ(response.uv_vertex(i), static_cast<std::uint32_t>(i));
  }
  ASSERT_EQ(response.corner_uv_size(), 3 * triangles);
  for (int i = 0; i < 3 * triangles; ++i) {
    ASSERT_LT(response.corner_uv(i), uv.size());
    EXPECT_EQ(response.uv_vertex(static_cast<int>(response.corner_uv(i))),
              request.mesh().triangles(i));
  }

  ASSERT_EQ(response.triangle_chart_size(), triangles);
  std::vector<std::uint64_t> counts(static_cast<std::size_t>(response.charts_size()), 0);
  std::uint32_t next = 0;
  for (const std::uint32_t chart : response.triangle_chart()) {
    ASSERT_LE(chart, next) << "charts are numbered by their lowest triangle";
    next = std::max(next, chart + 1);
    ++counts[chart];
  }
  EXPECT_EQ(next, counts.size());
  std::uint64_t flipped = 0;
  for (int i = 0; i < response.charts_size(); ++i) {
    EXPECT_EQ(response.charts(i).triangle_count(), counts[static_cast<std::size_t>(i)]);
    EXPECT_FALSE(response.charts(i).loops().empty());
    flipped += response.charts(i).distortion().flipped();
  }
  EXPECT_EQ(response.distortion().flipped(), flipped);
  EXPECT_LT(response.distortion().worst_triangle(), static_cast<std::uint32_t>(triangles));

  const std::vector<Triangle> flat = FlatTriangles(response);
  const std::vector<std::string> kinds = Kinds(response);
  const bool turned = std::find(kinds.begin(), kinds.end(), "reversed_triangles") != kinds.end();
  ExpectLoops(response, flat, turned);
  // Triangles without area have no side.
  if (!turned && response.left_out_triangles().empty()) {
    EXPECT_EQ(testing::CountFlipped(flat, uv), flipped);
  }
  EXPECT_EQ(response.cut_edges_size() % 2, 0);
  EXPECT_LE(2 * response.auto_cut_count(), static_cast<std::uint32_t>(response.cut_edges_size()));
}

void ExpectNeighbours(const v1::FlattenRequest& request, const std::string& elements) {
  int a = -1;
  int b = -1;
  ASSERT_EQ(std::sscanf(elements.c_str(), "%d,%d", &a, &b), 2) << elements;
  int shared = 0;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      shared += request.mesh().triangles(3 * a + i) == request.mesh().triangles(3 * b + k);
    }
  }
  EXPECT_EQ(shared, 2) << elements;
}

std::vector<std::string> Kinds(const v1::FlattenResponse& response) {
  std::vector<std::string> kinds;
  for (const v1::Warning& warning : response.warnings()) kinds.push_back(warning.kind());
  return kinds;
}

grpc::Status FlattenTest::Flatten(const v1::FlattenRequest& request,
                                  v1::FlattenResponse* response) {
  grpc::ClientContext context;
  SetDeadline(context);
  return flattening().Flatten(&context, request, response);
}

v1::FlattenResponse FlattenTest::Flat(const v1::FlattenRequest& request) {
  v1::FlattenResponse response;
  const grpc::Status status = Flatten(request, &response);
  EXPECT_TRUE(status.ok()) << status.error_message();
  if (status.ok()) ExpectConsistent(request, response);
  return response;
}

WireError FlattenTest::Refusal(const v1::FlattenRequest& request, grpc::StatusCode code,
                               const char* reason) {
  v1::FlattenResponse response;
  const WireError error = ExpectError(Flatten(request, &response), code, reason);
  EXPECT_EQ(response.uv_size() + response.uv64_size(), 0);
  EXPECT_TRUE(Flatten(RequestFor(BentStrip()), &response).ok()) << "it goes on serving";
  return error;
}

}  // namespace arap::wire
