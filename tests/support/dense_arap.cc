#include "tests/support/dense_arap.h"

#include <cmath>

#include <Eigen/Dense>

#include "core/mesh/space.h"

namespace arap::testing {
namespace {

using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;

Vector2d AsVector(Complex z) { return {z.real(), z.imag()}; }

// ½cot of the angle at corner k, by the law of cosines.
double HalfCotangent(const std::array<Complex, 3>& corners, std::size_t k) {
  const double a = std::norm(corners[(k + 2) % 3] - corners[(k + 1) % 3]);
  const double b = std::norm(corners[k] - corners[(k + 2) % 3]);
  const double c = std::norm(corners[(k + 1) % 3] - corners[k]);
  const Vector2d u = AsVector(corners[(k + 1) % 3] - corners[k]);
  const Vector2d v = AsVector(corners[(k + 2) % 3] - corners[k]);
  const double doubled_area = std::abs(u.x() * v.y() - u.y() * v.x());
  return 0.25 * (b + c - a) / doubled_area;
}

// The edge opposite to corner k runs from corner k+1 to corner k+2.
struct CellEdge {
  std::size_t a, b;
};
CellEdge EdgeOpposite(std::size_t k) { return {(k + 1) % 3, (k + 2) % 3}; }

std::array<Complex, 3> Corners(const Triangle& triangle, std::span<const Complex> shape) {
  return {shape[triangle[0]], shape[triangle[1]], shape[triangle[2]]};
}

// The rotation closest to the map of the cell (orthogonal Procrustes with positive determinant).
Matrix2d BestRotation(const std::array<Complex, 3>& rest, const std::array<Complex, 3>& image) {
  Matrix2d s = Matrix2d::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    const auto [a, b] = EdgeOpposite(k);
    s += HalfCotangent(rest, k) * AsVector(image[b] - image[a]) *
         AsVector(rest[b] - rest[a]).transpose();
  }
  const Eigen::JacobiSVD<Matrix2d> svd(s, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix2d fix = Matrix2d::Identity();
  fix(1, 1) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * fix * svd.matrixV().transpose();
}

double CellEnergy(const std::array<Complex, 3>& rest, const std::array<Complex, 3>& image) {
  const Matrix2d rotation = BestRotation(rest, image);
  double energy = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto [a, b] = EdgeOpposite(k);
    energy +=
        HalfCotangent(rest, k) *
        (AsVector(image[b] - image[a]) - rotation * AsVector(rest[b] - rest[a])).squaredNorm();
  }
  return energy;
}

MatrixXd Laplacian(const FaceCells& cells) {
  const auto n = static_cast<Index>(cells.vertices);
  MatrixXd l = MatrixXd::Zero(n, n);
  for (std::size_t t = 0; t < cells.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = EdgeOpposite(k);
      const auto i = static_cast<Index>(cells.triangles[t][a]);
      const auto j = static_cast<Index>(cells.triangles[t][b]);
      const double w = HalfCotangent(cells.rest[t], k);
      l(i, i) += w;
      l(j, j) += w;
      l(i, j) -= w;
      l(j, i) -= w;
    }
  }
  return l;
}

MatrixXd TurnedEdges(const FaceCells& cells, std::span<const Complex> shape) {
  MatrixXd rhs = MatrixXd::Zero(static_cast<Index>(cells.vertices), 2);
  for (std::size_t t = 0; t < cells.triangles.size(); ++t) {
    const Triangle& triangle = cells.triangles[t];
    const Matrix2d rotation = BestRotation(cells.rest[t], Corners(triangle, shape));
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = EdgeOpposite(k);
      const Vector2d edge = HalfCotangent(cells.rest[t], k) * rotation *
                            AsVector(cells.rest[t][b] - cells.rest[t][a]);
      rhs.row(static_cast<Index>(triangle[b])) += edge.transpose();
      rhs.row(static_cast<Index>(triangle[a])) -= edge.transpose();
    }
  }
  return rhs;
}

}  // namespace

FaceCells CellsOf(const PlanarMesh& mesh) {
  FaceCells cells{mesh.vertices.size(), mesh.triangles, {}};
  for (const Triangle& t : mesh.triangles) cells.rest.push_back(Corners(t, mesh.vertices));
  return cells;
}

FaceCells CellsOf(const SurfaceMesh& mesh) {
  FaceCells cells{mesh.vertices.size(), mesh.triangles, {}};
  for (const Triangle& t : mesh.triangles) {
    const Eigen::Vector3d ab = Vec(mesh.vertices[t[1]]) - Vec(mesh.vertices[t[0]]);
    const Eigen::Vector3d ac = Vec(mesh.vertices[t[2]]) - Vec(mesh.vertices[t[0]]);
    const double length = ab.norm();
    cells.rest.push_back({Complex(0, 0), Complex(length, 0),
                          Complex(ac.dot(ab) / length, ab.cross(ac).norm() / length)});
  }
  return cells;
}

double FaceEnergy(const FaceCells& cells, std::span<const Complex> shape) {
  double energy = 0;
  for (std::size_t t = 0; t < cells.triangles.size(); ++t) {
    energy += CellEnergy(cells.rest[t], Corners(cells.triangles[t], shape));
  }
  return energy;
}

DenseArapResult DenseArap(const FaceCells& cells, std::span<const TextbookHandle> handles,
                          std::span<const Complex> targets, std::span<const Complex> start,
                          int iterations) {
  const auto n = static_cast<Index>(cells.vertices);
  MatrixXd matrix = Laplacian(cells);
  MatrixXd fixed = MatrixXd::Zero(n, 2);
  for (std::size_t h = 0; h < handles.size(); ++h) {
    Eigen::VectorXd row = Eigen::VectorXd::Zero(n);
    for (std::size_t corner = 0; corner < 3; ++corner) {
      row(static_cast<Index>(handles[h].vertices[corner])) += handles[h].weights[corner];
    }
    matrix += handles[h].weight * row * row.transpose();
    fixed += handles[h].weight * row * AsVector(targets[h]).transpose();
  }
  for (Index i = 0; i < n; ++i) {
    if (matrix(i, i) != 0) continue;
    matrix(i, i) = 1;
    fixed.row(i) = AsVector(start[static_cast<std::size_t>(i)]).transpose();
  }
  if (handles.empty()) {
    // Any positive multiple of 1·1ᵗ fills the null space and changes nothing else.
    matrix += Eigen::MatrixXd::Ones(n, n);
    Complex sum;
    for (const Complex& p : start) sum += p;
    fixed += Eigen::VectorXd::Ones(n) * AsVector(sum).transpose();
  }
  const Eigen::ColPivHouseholderQR<MatrixXd> factor(matrix);

  DenseArapResult result;
  result.positions.assign(start.begin(), start.end());
  for (int iteration = 0; iteration < iterations; ++iteration) {
    const MatrixXd next = factor.solve(fixed + TurnedEdges(cells, result.positions));
    for (Index i = 0; i < n; ++i) {
      result.positions[static_cast<std::size_t>(i)] = Complex(next(i, 0), next(i, 1));
    }
  }
  result.energy = FaceEnergy(cells, result.positions);
  result.total_energy = result.energy;
  for (std::size_t h = 0; h < handles.size(); ++h) {
    Complex point;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      point += handles[h].weights[corner] * result.positions[handles[h].vertices[corner]];
    }
    result.total_energy += handles[h].weight * std::norm(point - targets[h]);
  }
  return result;
}

}  // namespace arap::testing
