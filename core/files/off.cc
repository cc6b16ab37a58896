#include "core/files/off.h"

#include <sstream>
#include <utility>

#include <CGAL/IO/OFF.h>

#include "core/files/soup.h"

namespace arap {

Result<SurfaceMesh> ParseOff(std::string text) {
  std::istringstream stream(std::move(text));
  Soup soup;
  const bool read = CGAL::IO::read_OFF(stream, soup.points, soup.polygons);
  return ToMesh(soup, read, ".off");
}

}  // namespace arap
