// FlattenTest: flattening over the wire, and what has to hold of every answer.
#pragma once

#include <string>
#include <vector>

#include "arap/model/mesh.h"
#include "tests/system/wire/wire_fixture.h"

namespace arap::wire {

v1::FlattenRequest RequestFor(const SurfaceMesh& mesh);

// A strip of 6 flat facets bent about an axis, 6 × 2 when flat: it unrolls without distortion.
// Vertices 2i and 2i + 1 are at the two ends of ruling i.
SurfaceMesh BentStrip();

// Three sheets on the edge 0-1.
SurfaceMesh Fan();

// Two triangles that touch in vertex 0.
SurfaceMesh Bowtie();

// Flat positions of an answer, in whichever precision.
std::vector<Complex> Positions(const v1::FlattenResponse& response);

// Everything in the answer agrees with the request and with itself: lengths, corners, charts, loops
// (every boundary segment of every chart once, in order), flips recounted, areas.
void ExpectConsistent(const v1::FlattenRequest& request, const v1::FlattenResponse& response);

// Two triangles of `elements` that share an edge in the request.
void ExpectNeighbours(const v1::FlattenRequest& request, const std::string& elements);

// The kinds of the warnings, in order.
std::vector<std::string> Kinds(const v1::FlattenResponse& response);

class FlattenTest : public WireTest {
 protected:
  grpc::Status Flatten(const v1::FlattenRequest& request, v1::FlattenResponse* response);
  // Expects success and consistency.
  v1::FlattenResponse Flat(const v1::FlattenRequest& request);
  // Expects a refusal, and that the server goes on serving.
  WireError Refusal(const v1::FlattenRequest& request, grpc::StatusCode code, const char* reason);
};

}  // namespace arap::wire
