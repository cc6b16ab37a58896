#include "tests/bench/cgal_parameterizer.h"

#include <cstdlib>

#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_parameterization/ARAP_parameterizer_3.h>
#include <CGAL/Surface_mesh_parameterization/LSCM_parameterizer_3.h>
#include <CGAL/Surface_mesh_parameterization/parameterize.h>

#include "core/mesh/space.h"

namespace arap::bench {
namespace {

namespace smp = CGAL::Surface_mesh_parameterization;

using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Vertex = Mesh::Vertex_index;
using UvMap = Mesh::Property_map<Vertex, Kernel::Point_2>;

Mesh MeshOf(const SurfaceMesh& surface) {
  Mesh mesh;
  for (const auto& p : surface.vertices) mesh.add_vertex(Kernel::Point_3(p[0], p[1], p[2]));
  for (const Triangle& t : surface.triangles) {
    const auto face = mesh.add_face(Vertex(t[0]), Vertex(t[1]), Vertex(t[2]));
    if (face == Mesh::null_face()) std::abort();
  }
  return mesh;
}

}  // namespace

struct CgalParameterizer::Data {
  explicit Data(const SurfaceMesh& surface)
      : mesh(MeshOf(surface)), uv(mesh.add_property_map<Vertex, Kernel::Point_2>("v:uv").first) {}

  template <class Parameterizer>
  smp::Error_code Run() {
    const auto border = CGAL::Polygon_mesh_processing::longest_border(mesh).first;
    return smp::parameterize(mesh, Parameterizer(), border, uv);
  }

  Mesh mesh;
  UvMap uv;
};

bool CgalParameterizer::Available() { return true; }

CgalParameterizer::CgalParameterizer(const SurfaceMesh& mesh)
    : data_(std::make_unique<Data>(mesh)) {}
CgalParameterizer::~CgalParameterizer() = default;

std::string CgalParameterizer::Run(CgalMethod method) {
  const smp::Error_code code = method == CgalMethod::kLscm
                                   ? data_->Run<smp::LSCM_parameterizer_3<Mesh>>()
                                   : data_->Run<smp::ARAP_parameterizer_3<Mesh>>();
  return code == smp::OK ? std::string() : smp::get_error_message(code);
}

std::vector<Complex> CgalParameterizer::uv() const {
  std::vector<Complex> result;
  for (const Vertex v : data_->mesh.vertices()) {
    const auto& p = data_->uv[v];
    result.emplace_back(p.x(), p.y());
  }
  return result;
}

}  // namespace arap::bench
