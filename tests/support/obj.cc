#include "tests/support/obj.h"

#include <array>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

namespace arap::testing {

SurfaceMesh ReadObj(const std::filesystem::path& file) {
  SurfaceMesh mesh;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    std::istringstream words(line);
    std::string kind;
    std::array<std::string, 3> parts;
    if (!(words >> kind >> parts[0] >> parts[1] >> parts[2])) continue;
    if (kind == "v") {
      mesh.vertices.push_back({std::strtod(parts[0].c_str(), nullptr),
                               std::strtod(parts[1].c_str(), nullptr),
                               std::strtod(parts[2].c_str(), nullptr)});
    } else if (kind == "f") {
      Triangle t{};
      for (std::size_t k = 0; k < 3; ++k) {
        t[k] = static_cast<std::uint32_t>(std::strtoul(parts[k].c_str(), nullptr, 10) - 1);
      }
      mesh.triangles.push_back(t);
    }
  }
  return mesh;
}

std::optional<std::filesystem::path> TestData() {
  const char* folder = std::getenv("ARAP_TEST_DATA");
  if (folder == nullptr || *folder == '\0') return std::nullopt;
  return std::filesystem::path(folder);
}

}  // namespace arap::testing
