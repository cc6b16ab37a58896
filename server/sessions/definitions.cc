#include "server/sessions/definitions.h"

#include <algorithm>
#include <set>
#include <string_view>

namespace arap::app {
namespace {

struct SameAnchor {
  bool operator()(const VertexAnchor& a, const VertexAnchor& b) const {
    return a.vertex == b.vertex;
  }
  bool operator()(const TriangleAnchor& a, const TriangleAnchor& b) const {
    return a.triangle == b.triangle && a.barycentric == b.barycentric;
  }
  bool operator()(const PointAnchor& a, const PointAnchor& b) const {
    return a.position == b.position;
  }
  template <class A, class B>
  bool operator()(const A&, const B&) const {
    return false;
  }
};

bool SameHandle(const Handle& a, const Handle& b) {
  return a.id == b.id && std::visit(SameAnchor{}, a.anchor, b.anchor) && a.weight == b.weight &&
         a.hard == b.hard && a.oriented == b.oriented && a.area_radius == b.area_radius &&
         a.outside == b.outside && a.depth == b.depth && a.depth_falloff == b.depth_falloff;
}

}  // namespace

bool SameDefinitions(const std::vector<Handle>& a, const std::vector<Handle>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), SameHandle);
}

std::vector<Handle> EditDefinitions(const std::vector<Handle>& definitions,
                                    const std::vector<std::string>& remove,
                                    const std::vector<Handle>& add) {
  const std::set<std::string_view> gone(remove.begin(), remove.end());
  std::vector<Handle> edited;
  for (const Handle& handle : definitions) {
    if (!gone.contains(handle.id)) edited.push_back(handle);
  }
  edited.insert(edited.end(), add.begin(), add.end());
  return edited;
}

}  // namespace arap::app
