#include "tests/bench/cgal_scheme.h"

#include <cstdlib>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_deformation.h>
#include <CGAL/version.h>
#include <fmt/format.h>

namespace arap::bench {
namespace {

using Point = CGAL::Simple_cartesian<double>::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;
using Deformation =
    CGAL::Surface_mesh_deformation<Mesh, CGAL::Default, CGAL::Default, CGAL::ORIGINAL_ARAP>;
using Vertex = Mesh::Vertex_index;

Mesh MeshOf(const PlanarMesh& planar) {
  Mesh mesh;
  for (const Complex p : planar.vertices) mesh.add_vertex(Point(p.real(), p.imag(), 0));
  for (const Triangle& t : planar.triangles) {
    const auto face = mesh.add_face(Vertex(t[0]), Vertex(t[1]), Vertex(t[2]));
    if (face == Mesh::null_face()) std::abort();
  }
  return mesh;
}

class Scheme final : public CgalScheme {
 public:
  explicit Scheme(const PlanarMesh& planar) : mesh_(MeshOf(planar)), deformation_(mesh_) {
    deformation_.insert_roi_vertices(mesh_.vertices_begin(), mesh_.vertices_end());
  }

  void SetHandles(std::span<const std::uint32_t> vertices) override {
    handles_.clear();
    for (const std::uint32_t v : vertices) handles_.emplace_back(v);
    deformation_.clear_control_vertices();
    deformation_.insert_control_vertices(handles_.begin(), handles_.end());
  }

  void Preprocess() override {
    if (!deformation_.preprocess()) std::abort();
  }

  void Iterate(std::span<const Complex> targets) override {
    for (std::size_t i = 0; i < handles_.size(); ++i) {
      deformation_.set_target_position(handles_[i], Point(targets[i].real(), targets[i].imag(), 0));
    }
    deformation_.deform(1, 0);
  }

  Complex Position(std::uint32_t vertex) const override {
    const Point& p = mesh_.point(Vertex(vertex));
    return {p.x(), p.y()};
  }

 private:
  Mesh mesh_;
  Deformation deformation_;
  std::vector<Vertex> handles_;
};

}  // namespace

std::unique_ptr<CgalScheme> CgalScheme::Make(const PlanarMesh& mesh) {
  return std::make_unique<Scheme>(mesh);
}
std::string CgalScheme::Version() {
  return fmt::format("{}.{}.{}", CGAL_VERSION_MAJOR, CGAL_VERSION_MINOR, CGAL_VERSION_PATCH);
}

}  // namespace arap::bench
