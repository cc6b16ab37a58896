// Seeded handle sets and the places to drag them to.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "arap/model/handle.h"
#include "arap/model/mesh.h"
#include "tests/support/textbook.h"

namespace arap::testing {

// A handle on one vertex, by the name "v" and its number.
Handle AtVertex(std::uint32_t vertex);
Handle AtVertex(std::string id, std::uint32_t vertex);

// The same for the textbook.
TextbookHandle OnVertex(std::uint32_t vertex, double weight = 1e6);

// `count` handles on different vertices that triangles use; with two or more, never all on one
// spot.
std::vector<TextbookHandle> RandomVertexHandles(const PlanarMesh& mesh, std::size_t count,
                                                std::uint64_t seed, double weight = 1e6);

// `count` handles strictly inside different triangles. count <= #F.
std::vector<TextbookHandle> RandomInnerHandles(const PlanarMesh& mesh, std::size_t count,
                                               std::uint64_t seed, double weight = 1e6);

// Where the handles are at rest.
std::vector<Complex> RestTargets(const PlanarMesh& mesh, std::span<const TextbookHandle> handles);

// `rest` turned about its centre and moved as a whole, then every point moved on its own by up to
// `spread` diagonals of the mesh in x and in y.
std::vector<Complex> RandomPose(const PlanarMesh& mesh, std::span<const Complex> rest,
                                double spread, std::uint64_t seed);

}  // namespace arap::testing
