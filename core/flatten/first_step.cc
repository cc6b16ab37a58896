#include "core/flatten/first_step.h"

#include <cmath>

#include "core/energy/assemble.h"

namespace arap {
namespace {

// The energy has null directions: constants always, the exact map of a developable surface too.
// Raised by this part of its mean diagonal it can be factored, and inverse iteration only converges
// faster.
constexpr double kShift = 1e-10;
constexpr int kMaxSpectralSteps = 60;

// The surface seen along its mean normal, so that it lies upright: a start with the right
// orientation.
std::vector<Complex> Shadow(const SurfaceChart& chart) {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  const auto& p = chart.mesh.vertices;
  for (const Triangle& t : chart.mesh.triangles) {
    normal += (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]);
  }
  if (normal.norm() < 1e-6) normal = Eigen::Vector3d::UnitZ();
  normal.normalize();
  Eigen::Index smallest = 0;
  normal.cwiseAbs().minCoeff(&smallest);
  const Eigen::Vector3d u = Eigen::Vector3d::Unit(smallest).cross(normal).normalized();
  const Eigen::Vector3d v = normal.cross(u);
  std::vector<Complex> shadow;
  for (const Eigen::Vector3d& q : p) shadow.emplace_back(q.dot(u), q.dot(v));
  return shadow;
}

// Vertices of all boundaries.
std::vector<std::uint32_t> Boundary(const SurfaceChart& chart) {
  std::vector<std::uint32_t> boundary;
  for (const auto& loop : chart.loops) boundary.insert(boundary.end(), loop.begin(), loop.end());
  return boundary;
}

// right := the boundary part of x, around its mean, with unit norm. False when it has no spread.
bool Spread(const std::vector<std::uint32_t>& boundary, const std::vector<Complex>& x,
            std::vector<Complex>& right) {
  std::fill(right.begin(), right.end(), Complex(0));
  Complex mean = 0;
  for (const std::uint32_t v : boundary) mean += x[v];
  mean /= static_cast<double>(boundary.size());
  double size = 0;
  for (const std::uint32_t v : boundary) size += std::norm(x[v] - mean);
  size = std::sqrt(size);
  if (!(size > 0) || !std::isfinite(size)) return false;
  for (const std::uint32_t v : boundary) right[v] = (x[v] - mean) / size;
  return true;
}

double Area(const SurfaceChart& chart) {
  double area = 0;
  for (const auto& frame : chart.frames) area += 0.5 * frame[1].real() * frame[2].imag();
  return area;
}

double FlatArea(const SurfaceChart& chart, const std::vector<Complex>& x) {
  double area = 0;
  for (const Triangle& t : chart.mesh.triangles) {
    area += 0.5 * std::imag(std::conj(x[t[1]] - x[t[0]]) * (x[t[2]] - x[t[0]]));
  }
  return area;
}

}  // namespace

Result<GroundedSystem<Complex>> HeldSystem(const Cells& cells, const Held& held,
                                           std::size_t vertices) {
  Eigen::SparseMatrix<Complex> matrix =
      AssembleSimilarity(cells, std::vector<bool>(vertices, false));
  for (const HeldVertex& h : held.vertices) {
    const auto v = static_cast<Eigen::Index>(h.vertex);
    if (h.weight > 0) matrix.coeffRef(v, v) += h.weight;
  }
  return GroundedSystem<Complex>::Make(matrix, held.Fixed(vertices), FactorLayout::kSupernodal);
}

Result<std::vector<Complex>> HeldFirstStep(const GroundedSystem<Complex>& system, const Held& held,
                                           std::size_t vertices) {
  std::vector<Complex> x(vertices), right(vertices);
  for (const HeldVertex& h : held.vertices) {
    if (h.weight == 0) x[h.vertex] = h.uv;
    right[h.vertex] += h.weight * h.uv;
  }
  Workspace workspace;
  if (auto ok = system.Solve(right, 1, x, workspace); !ok) return Fail(std::move(ok.error()));
  return x;
}

Result<GroundedSystem<Complex>> SpectralSystem(const Cells& cells, std::size_t vertices) {
  const std::vector<bool> none(vertices, false);
  Eigen::SparseMatrix<Complex> matrix = AssembleSimilarity(cells, none);
  const double shift = kShift * matrix.diagonal().real().mean();
  for (Eigen::Index v = 0; v < matrix.rows(); ++v) matrix.coeffRef(v, v) += shift;
  return GroundedSystem<Complex>::Make(matrix, none, FactorLayout::kSupernodal);
}

Result<std::vector<Complex>> SpectralFirstStep(const GroundedSystem<Complex>& system,
                                               const SurfaceChart& chart,
                                               const std::array<std::uint32_t, 2>& anchors,
                                               double accuracy, const CancelToken& cancel) {
  const std::size_t n = chart.mesh.vertices.size();
  const std::vector<std::uint32_t> boundary = Boundary(chart);
  std::vector<Complex> x = Shadow(chart), right(n), last(n);
  Workspace workspace;
  const Fault no_spread{
      FaultKind::kNumerical, "the boundary of the first step has no spread", {}, {}, {}};
  if (!Spread(boundary, x, right)) return Fail(no_spread);
  for (int step = 0; step < kMaxSpectralSteps; ++step) {
    if (auto ok = cancel.Check(); !ok) return Fail(std::move(ok.error()));
    last = right;
    if (auto ok = system.Solve(right, 1, x, workspace); !ok) return Fail(std::move(ok.error()));
    if (!Spread(boundary, x, right)) return Fail(no_spread);
    Complex common = 0;
    for (const std::uint32_t v : boundary) common += std::conj(last[v]) * right[v];
    double change = 0;
    for (const std::uint32_t v : boundary) change += std::norm(right[v] - common * last[v]);
    if (change < accuracy * accuracy) break;
  }

  // True area, the centre edge along the real axis. Its direction may be lost in a fold; any will
  // do then.
  const Complex origin = x[anchors[0]], along = x[anchors[1]] - origin;
  const double flat = std::abs(FlatArea(chart, x));
  const double scale = std::sqrt(Area(chart) / flat);
  const double length = std::abs(along);
  const Complex turn = length > 0 ? std::conj(along) / length : Complex(1);
  for (Complex& p : x) p = scale * (turn * (p - origin));
  return x;
}

}  // namespace arap
