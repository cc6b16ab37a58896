// Reading the meshes of a data folder, for tests that have one.
#pragma once

#include <filesystem>
#include <optional>

#include "arap/model/mesh.h"

namespace arap::testing {

// Vertices and triangles of an OBJ file; what else is in it is passed over. "nan" is read as such.
// Empty when the file cannot be read.
SurfaceMesh ReadObj(const std::filesystem::path& file);

// The folder that the environment variable ARAP_TEST_DATA names, if it does.
std::optional<std::filesystem::path> TestData();

}  // namespace arap::testing
