#include "tests/support/textbook.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Dense>

#include "core/mesh/space.h"

namespace arap::testing {
namespace {

using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

// [x y; y −x]: the columns multiply c and s.
Matrix2d Columns(const Vector2d& v) {
  Matrix2d m;
  m << v.x(), v.y(), v.y(), -v.x();
  return m;
}

// The 2 × 2m matrix that maps the stacked positions of the hinge's vertices to (c, s): (GᵗG)⁻¹Gᵗ,
// with the differences from v_i written out as columns of v_i.
MatrixXd FitOperator(const Hinge& hinge, Slip slip) {
  const auto m = static_cast<Index>(hinge.vertices.size());
  const bool absolute = slip == Slip::kAbsoluteFit;
  MatrixXd g = MatrixXd::Zero(2 * m, 2);
  // Row pairs pick a position, or its difference from v_i (whose own row pair is then zero).
  MatrixXd pick = MatrixXd::Zero(2 * m, 2 * m);
  for (Index q = 0; q < m; ++q) {
    if (!absolute && q == 0) continue;
    const auto n = static_cast<std::size_t>(q);
    g.middleRows<2>(2 * q) =
        Columns(absolute ? hinge.rest[n] : Vector2d(hinge.rest[n] - hinge.rest[0]));
    pick.block<2, 2>(2 * q, 2 * q).setIdentity();
    if (!absolute) pick.block<2, 2>(2 * q, 0) = -Matrix2d::Identity();
  }
  const Matrix2d normal = g.transpose() * g;
  return normal.inverse() * g.transpose() * pick;
}

Vector2d EdgeVector(const Hinge& hinge) { return hinge.rest[1] - hinge.rest[0]; }

// The top of A1: two rows per hinge, 2n columns x0 y0 x1 y1 …
MatrixXd FirstMatrix(const std::vector<Hinge>& hinges, std::size_t n, Slip slip) {
  MatrixXd a1 = MatrixXd::Zero(2 * static_cast<Index>(hinges.size()), 2 * static_cast<Index>(n));
  Index row = 0;
  for (const Hinge& hinge : hinges) {
    MatrixXd h = -Columns(EdgeVector(hinge)) * FitOperator(hinge, slip);
    h.block<2, 2>(0, 0) -= Matrix2d::Identity();
    h.block<2, 2>(0, 2) += Matrix2d::Identity();
    h *= std::sqrt(hinge.weight);
    for (std::size_t q = 0; q < hinge.vertices.size(); ++q) {
      a1.block<2, 2>(row, 2 * static_cast<Index>(hinge.vertices[q])) +=
          h.middleCols<2>(2 * static_cast<Index>(q));
    }
    row += 2;
  }
  return a1;
}

// The top of A2: one row per hinge, the same for x and y.
MatrixXd SecondMatrix(const std::vector<Hinge>& hinges, std::size_t n) {
  MatrixXd a2 = MatrixXd::Zero(static_cast<Index>(hinges.size()), static_cast<Index>(n));
  Index row = 0;
  for (const Hinge& hinge : hinges) {
    a2(row, static_cast<Index>(hinge.vertices[0])) = -std::sqrt(hinge.weight);
    a2(row, static_cast<Index>(hinge.vertices[1])) = std::sqrt(hinge.weight);
    ++row;
  }
  return a2;
}

// The top of b2: edge vectors turned by the rotations of the first step's result, x and y columns.
MatrixXd TurnedEdges(const std::vector<Hinge>& hinges, const VectorXd& first, Slip slip) {
  MatrixXd b2(static_cast<Index>(hinges.size()), 2);
  Index row = 0;
  for (const Hinge& hinge : hinges) {
    VectorXd local(2 * static_cast<Index>(hinge.vertices.size()));
    for (std::size_t q = 0; q < hinge.vertices.size(); ++q) {
      local.segment<2>(2 * static_cast<Index>(q)) =
          first.segment<2>(2 * static_cast<Index>(hinge.vertices[q]));
    }
    Vector2d cs = FitOperator(hinge, slip) * local;
    cs /= slip == Slip::kSquaredNormaliser ? cs.squaredNorm() : cs.norm();
    b2.row(row) = std::sqrt(hinge.weight) * (Columns(EdgeVector(hinge)) * cs).transpose();
    ++row;
  }
  return b2;
}

MatrixXd LeastSquares(const MatrixXd& a, const MatrixXd& b) {
  return a.colPivHouseholderQr().solve(b);
}

MatrixXd Stacked(const MatrixXd& top, const MatrixXd& bottom) {
  MatrixXd all(top.rows() + bottom.rows(), top.cols());
  all << top, bottom;
  return all;
}

// The columns of `a` in `fixed` have given values: moves them to the right-hand side.
MatrixXd LeastSquaresWithFixed(const MatrixXd& a, const MatrixXd& b,
                               const std::vector<std::pair<Index, Eigen::RowVectorXd>>& fixed) {
  MatrixXd rhs = b;
  std::vector<bool> is_fixed(static_cast<std::size_t>(a.cols()), false);
  for (const auto& [column, value] : fixed) {
    rhs -= a.col(column) * value;
    is_fixed[static_cast<std::size_t>(column)] = true;
  }
  std::vector<Index> open;
  for (Index c = 0; c < a.cols(); ++c) {
    if (!is_fixed[static_cast<std::size_t>(c)]) open.push_back(c);
  }
  MatrixXd reduced(a.rows(), static_cast<Index>(open.size()));
  for (std::size_t k = 0; k < open.size(); ++k) {
    reduced.col(static_cast<Index>(k)) = a.col(open[k]);
  }
  const MatrixXd solution = LeastSquares(reduced, rhs);
  MatrixXd all(a.cols(), b.cols());
  for (std::size_t k = 0; k < open.size(); ++k) {
    all.row(open[k]) = solution.row(static_cast<Index>(k));
  }
  for (const auto& [column, value] : fixed) all.row(column) = value;
  return all;
}

// The centroid moves to 0 and the diagonal of the bounding box becomes 1.
struct Frame {
  Complex centre;
  double diagonal = 1;
  Complex In(Complex v) const { return (v - centre) / diagonal; }
  Complex Out(double x, double y) const { return Complex(x, y) * diagonal + centre; }
};

Frame FrameOf(const std::vector<Complex>& vertices, const std::vector<bool>& used) {
  Frame frame;
  double count = 0;
  Vector2d low(1e300, 1e300);
  Vector2d high(-1e300, -1e300);
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (!used[v]) continue;
    frame.centre += vertices[v];
    count += 1;
    low = low.cwiseMin(Vector2d(vertices[v].real(), vertices[v].imag()));
    high = high.cwiseMax(Vector2d(vertices[v].real(), vertices[v].imag()));
  }
  frame.centre /= count;
  frame.diagonal = (high - low).norm();
  return frame;
}

std::vector<bool> UsedVertices(std::size_t n, const std::vector<Triangle>& triangles) {
  std::vector<bool> used(n, false);
  for (const Triangle& t : triangles) {
    for (const std::uint32_t v : t) used[v] = true;
  }
  return used;
}

}  // namespace

std::vector<Complex> TextbookDeform(const PlanarMesh& mesh, bool both_directions, Weights weights,
                                    std::span<const TextbookHandle> handles,
                                    std::span<const Complex> targets,
                                    std::vector<Complex>* first_step, Slip slip) {
  const std::size_t n = mesh.vertices.size();
  const std::vector<bool> used = UsedVertices(n, mesh.triangles);
  // The slip of eq. 3 depends on where the origin is, so there the coordinates stay as they are.
  const Frame frame = slip == Slip::kAbsoluteFit ? Frame{} : FrameOf(mesh.vertices, used);
  PlanarMesh rest = mesh;
  for (Complex& v : rest.vertices) v = frame.In(v);
  const std::vector<Hinge> hinges = PlanarHinges(rest, both_directions, weights);

  const auto k = static_cast<Index>(handles.size());
  MatrixXd c1 = MatrixXd::Zero(2 * k, 2 * static_cast<Index>(n));
  MatrixXd c2 = MatrixXd::Zero(k, static_cast<Index>(n));
  VectorXd d1(2 * k);
  MatrixXd d2(k, 2);
  for (Index h = 0; h < k; ++h) {
    const TextbookHandle& handle = handles[static_cast<std::size_t>(h)];
    const double row = std::sqrt(handle.weight);
    const Complex target = frame.In(targets[static_cast<std::size_t>(h)]);
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const auto v = static_cast<Index>(handle.vertices[corner]);
      const double entry = row * handle.weights[corner];
      c1(2 * h, 2 * v) += entry;
      c1(2 * h + 1, 2 * v + 1) += entry;
      c2(h, v) += entry;
    }
    d1.segment<2>(2 * h) << row * target.real(), row * target.imag();
    d2.row(h) << row * target.real(), row * target.imag();
  }

  const MatrixXd l1 = FirstMatrix(hinges, n, slip);
  const VectorXd first = LeastSquares(Stacked(l1, c1), Stacked(VectorXd::Zero(l1.rows()), d1));
  const MatrixXd second = LeastSquares(Stacked(SecondMatrix(hinges, n), c2),
                                       Stacked(TurnedEdges(hinges, first, slip), d2));

  std::vector<Complex> result = mesh.vertices;
  if (first_step != nullptr) *first_step = mesh.vertices;
  for (std::size_t v = 0; v < n; ++v) {
    if (!used[v]) continue;
    const auto i = static_cast<Index>(v);
    result[v] = frame.Out(second(i, 0), second(i, 1));
    if (first_step != nullptr) (*first_step)[v] = frame.Out(first(2 * i), first(2 * i + 1));
  }
  return result;
}

std::vector<Complex> TextbookFlatten(const SurfaceMesh& mesh, bool both_directions, Weights weights,
                                     std::uint32_t a, std::uint32_t b,
                                     std::vector<Complex>* first_step, Slip slip) {
  const std::size_t n = mesh.vertices.size();
  Eigen::AlignedBox3d box;
  for (const Point3& v : mesh.vertices) box.extend(Vec(v));
  const double unit = box.diagonal().norm();
  SurfaceMesh rest = mesh;
  for (Point3& v : rest.vertices) v = ToPoint3((Vec(v) - box.center()) / unit);
  const std::vector<Hinge> hinges = UnfoldedHinges(rest, both_directions, weights, slip);
  const double length = (Vec(rest.vertices[b]) - Vec(rest.vertices[a])).norm();

  const auto scalar = [](double value) { return Eigen::RowVectorXd::Constant(1, value).eval(); };
  const MatrixXd l1 = FirstMatrix(hinges, n, slip);
  const VectorXd first = LeastSquaresWithFixed(l1, VectorXd::Zero(l1.rows()),
                                               {{2 * static_cast<Index>(a), scalar(0)},
                                                {2 * static_cast<Index>(a) + 1, scalar(0)},
                                                {2 * static_cast<Index>(b), scalar(length)},
                                                {2 * static_cast<Index>(b) + 1, scalar(0)}});
  const MatrixXd second =
      LeastSquaresWithFixed(SecondMatrix(hinges, n), TurnedEdges(hinges, first, slip),
                            {{static_cast<Index>(a), Eigen::RowVectorXd::Zero(2)}});

  std::vector<Complex> result(n);
  if (first_step != nullptr) first_step->resize(n);
  for (std::size_t v = 0; v < n; ++v) {
    const auto i = static_cast<Index>(v);
    result[v] = unit * Complex(second(i, 0), second(i, 1));
    if (first_step != nullptr) (*first_step)[v] = unit * Complex(first(2 * i), first(2 * i + 1));
  }
  return result;
}

}  // namespace arap::testing
