#include "core/flatten/layout/first_step.h"

#include <algorithm>
#include <cmath>

#include "core/energy/assemble.h"
#include "core/mesh/space.h"

namespace arap {
namespace {

// The energy has null directions: constants always, the exact map of a developable surface too.
// Raised by this part of its mean diagonal it can be factored, and inverse iteration only converges
// faster.
constexpr double kShift = 1e-10;
constexpr int kMaxSpectralSteps = 60;
// The boundary (of norm 1) has settled when a step changes it by no more.
constexpr double kFinest = 1e-10, kRoughest = 1e-3;

// The surface seen along its mean normal, so that it lies upright: a start with the right
// orientation.
std::vector<Complex> Shadow(const SurfaceChart& chart) {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  const auto& p = chart.mesh.vertices;
  for (const Triangle& t : chart.mesh.triangles) {
    normal += (Vec(p[t[1]]) - Vec(p[t[0]])).cross(Vec(p[t[2]]) - Vec(p[t[0]]));
  }
  if (normal.norm() < 1e-6) normal = Eigen::Vector3d::UnitZ();
  normal.normalize();
  Eigen::Index smallest = 0;
  normal.cwiseAbs().minCoeff(&smallest);
  const Eigen::Vector3d u = Eigen::Vector3d::Unit(smallest).cross(normal).normalized();
  const Eigen::Vector3d v = normal.cross(u);
  std::vector<Complex> shadow;
  for (const Point3& q : p) shadow.emplace_back(Vec(q).dot(u), Vec(q).dot(v));
  return shadow;
}

// Vertices of all boundaries.
std::vector<std::uint32_t> Boundary(const SurfaceChart& chart) {
  std::vector<std::uint32_t> boundary;
  for (const auto& loop : chart.loops) boundary.insert(boundary.end(), loop.begin(), loop.end());
  return boundary;
}

// Moves and scales x so that its boundary has mean 0 and norm 1; `spread` (#V) becomes that
// boundary, 0 inside. Returns what it was divided by; not positive when there is no spread.
double Normalise(const std::vector<std::uint32_t>& boundary, std::vector<Complex>& x,
                 std::vector<Complex>& spread) {
  Complex mean = 0;
  for (const std::uint32_t v : boundary) mean += x[v];
  mean /= static_cast<double>(boundary.size());
  double size = 0;
  for (const std::uint32_t v : boundary) size += std::norm(x[v] - mean);
  size = std::sqrt(size);
  if (!(size > 0) || !std::isfinite(size)) return 0;
  for (Complex& p : x) p = (p - mean) / size;
  std::fill(spread.begin(), spread.end(), Complex(0));
  for (const std::uint32_t v : boundary) spread[v] = x[v];
  return size;
}

// Σ conj(a) b
Complex Dot(const std::vector<Complex>& a, const std::vector<Complex>& b) {
  Complex sum = 0;
  for (std::size_t v = 0; v < a.size(); ++v) sum += std::conj(a[v]) * b[v];
  return sum;
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

Result<Order> NewOrder(const Eigen::SparseMatrix<Complex>& lower) {
  auto order = EliminationOrder(lower);
  if (!order) return Fail(std::move(order.error()));
  return std::make_shared<const std::vector<int>>(*std::move(order));
}

Result<GroundedSystem<Complex>> HeldSystem(const Cells& cells, const Held& held,
                                           std::size_t vertices, const OrderSource& order) {
  Eigen::SparseMatrix<Complex> matrix =
      AssembleSimilarity(cells, std::vector<bool>(vertices, false));
  for (const HeldVertex& h : held.vertices) {
    const auto v = static_cast<Eigen::Index>(h.vertex);
    if (h.weight > 0) matrix.coeffRef(v, v) += h.weight;
  }
  auto found = order(matrix);
  if (!found) return Fail(std::move(found.error()));
  return GroundedSystem<Complex>::Make(matrix, held.Fixed(vertices), FactorLayout::kSupernodal,
                                       *std::move(found));
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

Result<GroundedSystem<Complex>> SpectralSystem(const Cells& cells, std::size_t vertices,
                                               const OrderSource& order) {
  const std::vector<bool> none(vertices, false);
  Eigen::SparseMatrix<Complex> matrix = AssembleSimilarity(cells, none);
  const double shift = kShift * matrix.diagonal().real().mean();
  for (Eigen::Index v = 0; v < matrix.rows(); ++v) matrix.coeffRef(v, v) += shift;
  auto found = order(matrix);
  if (!found) return Fail(std::move(found.error()));
  auto system =
      GroundedSystem<Complex>::Make(matrix, none, FactorLayout::kPacked, *std::move(found));
  if (system) system->set_raised(shift);
  return system;
}

Result<std::vector<Complex>> SpectralFirstStep(const GroundedSystem<Complex>& system,
                                               const SurfaceChart& chart,
                                               const std::array<std::uint32_t, 2>& anchors,
                                               double accuracy, const CancelToken& cancel) {
  const std::size_t n = chart.mesh.vertices.size();
  const std::vector<std::uint32_t> boundary = Boundary(chart);
  std::vector<Complex> x = Shadow(chart), right(n), spread(n), last;
  Workspace workspace;
  const double shift = system.raised(), scale_of_matrix = shift / kShift;
  // With M = H + shift: x ← M⁻¹ (shift·x + ρ·spread) rests where H x = ρ·spread, whatever the
  // shift. ρ is the energy of x, for which the start is no guide.
  double energy = 1, kept = 0;
  for (int step = 0; step <= kMaxSpectralSteps; ++step) {
    const double size = Normalise(boundary, x, spread);
    if (size == 0) {
      return Fail(FaultKind::kNumerical, "the boundary of the first step has no spread");
    }
    if (step > 0) {
      const double norm = Dot(x, x).real();
      energy = std::max(0.0, energy / (size * size) - shift * norm);
      kept = shift;
      const Complex common = Dot(last, spread);
      double change = 0;
      for (const std::uint32_t v : boundary) change += std::norm(spread[v] - common * last[v]);
      const double distortion = std::sqrt(energy / (scale_of_matrix * norm));
      const double goal = std::clamp(accuracy * distortion, kFinest, kRoughest);
      if (change < goal * goal || step == kMaxSpectralSteps) break;
    }
    if (auto ok = cancel.Check(); !ok) return Fail(std::move(ok.error()));
    last = spread;
    for (std::size_t v = 0; v < n; ++v) right[v] = kept * x[v] + energy * spread[v];
    const std::vector<Complex> asked = right;
    if (auto ok = system.Solve(right, 1, x, workspace); !ok) return Fail(std::move(ok.error()));
    energy = Dot(x, asked).real();  // xᴴ M x
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
