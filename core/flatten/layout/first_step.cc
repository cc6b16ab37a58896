#include "core/flatten/layout/first_step.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/plane.h"
#include "core/base/try.h"
#include "core/energy/assemble.h"
#include "core/mesh/space.h"
#include "core/sparse/elimination_order.h"
#include "core/sparse/saddle.h"

namespace arap {
namespace {

// The energy has null directions: constants always, the exact map of a developable surface too.
// Raised by this part of its mean diagonal it can be factored, and inverse iteration only converges
// faster.
constexpr double kShift = 1e-10;
constexpr int kMaxSpectralSteps = 60;
// The boundary (of norm 1) has settled when a step changes it by no more.
constexpr double kFinest = 1e-10, kRoughest = 1e-3;
// The same where it is only the start of a descent.
constexpr double kLoose = 0.02;
constexpr int kMaxLooseSteps = 6;

// The surface seen along its mean normal, so that it lies upright: a start with the right
// orientation.
std::vector<Complex> Shadow(const Chart& chart) {
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
std::vector<std::uint32_t> Boundary(const Chart& chart) {
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

double Area(const Chart& chart) {
  double area = 0;
  for (std::uint32_t t = 0; t < chart.triangles.size(); ++t) {
    const auto frame = chart.Frame(t);
    area += 0.5 * frame[1].real() * frame[2].imag();
  }
  return area;
}

double FlatArea(const Chart& chart, const std::vector<Complex>& x) {
  double area = 0;
  for (const Triangle& t : chart.mesh.triangles) {
    area += 0.5 * TwiceArea(t, x);
  }
  return area;
}

// Scales x to the true area and lays the edge `anchors` along the real axis, its first end at 0.
// Its direction may be lost in a fold; any will do then.
void LayAlong(const Chart& chart, const std::array<std::uint32_t, 2>& anchors,
              std::vector<Complex>& x) {
  const Complex origin = x[anchors[0]], along = x[anchors[1]] - origin;
  const double scale = std::sqrt(Area(chart) / std::abs(FlatArea(chart, x)));
  const double length = std::abs(along);
  const Complex turn = length > 0 ? std::conj(along) / length : Complex(1);
  for (Complex& p : x) p = scale * (turn * (p - origin));
}

// Pins solved for together: few enough to keep memory small and to be cancelled between.
constexpr std::size_t kBlock = 8;
// The shape is right when a correction changes it by no more than this part.
constexpr double kSettled = 1e-10;
constexpr int kMaxCorrections = 4;

// [algorithm §2] with the pins as rows; repeated on what is left until it settles.
class PinnedSolve {
 public:
  PinnedSolve(const GroundedSystem<Complex>& system, const std::array<std::uint32_t, 2>& ground,
              const Cells& cells, const Held& pins, std::size_t vertices)
      : system_(system),
        ground_(ground),
        cells_(cells),
        pins_(pins.vertices),
        n_(vertices),
        x_(n_),
        lambda_(pins_.size()) {}

  Result<std::optional<std::vector<Complex>>> Solve(const CancelToken& cancel) {
    CHECK_OK(FindDirection());
    CHECK_OK(MakeSaddle(cancel));
    for (int correction = 0; correction <= kMaxCorrections; ++correction) {
      CHECK_OK(cancel.Check());
      TRY(const double change, Correct());
      if (correction > 0 && change <= kSettled * Size(x_)) {
        for (const HeldVertex& pin : pins_) {
          if (pin.weight == 0) x_[pin.vertex] = pin.uv;
        }
        return std::move(x_);
      }
    }
    return std::optional<std::vector<Complex>>();
  }

 private:
  static double Size(const std::vector<Complex>& x) {
    double size = 0;
    for (const Complex p : x) size = std::max(size, std::norm(p));
    return std::sqrt(size);
  }

  // direction_ := the shape with the ground at 0 and 1; energy_ is its own.
  Status FindDirection() {
    direction_.assign(n_, 0);
    direction_[ground_[1]] = 1;
    std::vector<Complex> right(n_);
    CHECK_OK(system_.Solve(right, 1, direction_, workspace_));
    energy_ = std::max(0.0, SimilarityForceAt(cells_, direction_).energy);
    return {};
  }

  Status MakeSaddle(const CancelToken& cancel) {
    const std::size_t k = pins_.size();
    const auto rows = static_cast<Eigen::Index>(k);
    Eigen::MatrixXcd cz(rows, rows), cn(rows, 2), energy = Eigen::MatrixXcd::Zero(2, 2);
    std::vector<Complex> right, z;
    for (std::size_t begin = 0; begin < k; begin += kBlock) {
      CHECK_OK(cancel.Check());
      const std::size_t count = std::min(kBlock, k - begin);
      right.assign(n_ * count, 0);
      z.assign(n_ * count, 0);
      for (std::size_t j = 0; j < count; ++j) right[j * n_ + pins_[begin + j].vertex] = 1;
      CHECK_OK(system_.Solve(right, count, z, workspace_));
      for (std::size_t j = 0; j < count; ++j) {
        for (std::size_t i = 0; i < k; ++i) {
          cz(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(begin + j)) =
              z[j * n_ + pins_[i].vertex];
        }
      }
    }
    for (std::size_t i = 0; i < k; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      cz(row, row) += Held::Compliance(pins_[i]);
      cn(row, 0) = 1;
      cn(row, 1) = direction_[pins_[i].vertex];
    }
    energy(1, 1) = energy_;
    saddle_ = Saddle<Complex>(cz, cn, energy);
    scratch_.Resize(saddle_.size());
    return {};
  }

  // Takes from x_ and lambda_ what they still lack; the first time, that is everything. Returns
  // the largest change of a vertex.
  Result<double> Correct() {
    // What is left of  H x = Cᴴ λ  and  C x + E λ = c.
    std::vector<Complex> left = SimilarityForceAt(cells_, x_).force;
    for (Complex& f : left) f = -f;
    for (std::size_t i = 0; i < pins_.size(); ++i) left[pins_[i].vertex] += lambda_[i];
    Complex sum = 0, along = 0;
    for (std::size_t v = 0; v < n_; ++v) {
      sum += left[v];
      along += std::conj(direction_[v]) * left[v];
    }
    std::vector<Complex> right = left, change(n_);
    CHECK_OK(system_.Solve(right, 1, change, workspace_));
    const auto k = static_cast<Eigen::Index>(pins_.size());
    for (Eigen::Index i = 0; i < k; ++i) {
      const HeldVertex& pin = pins_[static_cast<std::size_t>(i)];
      scratch_.right[i] = pin.uv - x_[pin.vertex] - change[pin.vertex] -
                          Held::Compliance(pin) * lambda_[static_cast<std::size_t>(i)];
    }
    scratch_.right[k] = -sum;
    scratch_.right[k + 1] = -along;
    saddle_.Solve(scratch_);
    const auto& solution = scratch_.solution;
    right = left;
    for (Eigen::Index i = 0; i < k; ++i) {
      right[pins_[static_cast<std::size_t>(i)].vertex] += solution[i];
      lambda_[static_cast<std::size_t>(i)] += solution[i];
    }
    std::fill(change.begin(), change.end(), Complex(0));
    CHECK_OK(system_.Solve(right, 1, change, workspace_));
    for (std::size_t v = 0; v < n_; ++v) {
      change[v] += solution[k] + solution[k + 1] * direction_[v];
      x_[v] += change[v];
    }
    return Size(change);
  }

  const GroundedSystem<Complex>& system_;
  const std::array<std::uint32_t, 2> ground_;
  const Cells& cells_;
  const std::vector<HeldVertex>& pins_;
  const std::size_t n_;
  double energy_ = 0;
  std::vector<Complex> direction_, x_, lambda_;
  Saddle<Complex> saddle_;
  Saddle<Complex>::Scratch scratch_;
  Workspace workspace_;
};

}  // namespace

Result<Order> NewOrder(const Eigen::SparseMatrix<Complex>& lower) {
  TRY(auto order, EliminationOrder(lower));
  return std::make_shared<const std::vector<int>>(std::move(order));
}

Result<GroundedSystem<Complex>> HeldSystem(const Cells& cells, const Held& held,
                                           std::size_t vertices, const OrderSource& order,
                                           const std::function<void()>& assembled) {
  Eigen::SparseMatrix<Complex> matrix =
      AssembleSimilarity(cells, std::vector<bool>(vertices, false));
  if (assembled) assembled();
  for (const HeldVertex& h : held.vertices) {
    const auto v = static_cast<Eigen::Index>(h.vertex);
    if (h.weight > 0) matrix.coeffRef(v, v) += h.weight;
  }
  TRY(const Order found, order(matrix));
  return GroundedSystem<Complex>::Make(std::move(matrix), held.Fixed(vertices),
                                       FactorLayout::kSupernodal, found);
}

Result<std::vector<Complex>> HeldFirstStep(const GroundedSystem<Complex>& system, const Held& held,
                                           std::size_t vertices) {
  std::vector<Complex> x(vertices), right(vertices);
  for (const HeldVertex& h : held.vertices) {
    if (h.weight == 0) x[h.vertex] = h.uv;
    right[h.vertex] += h.weight * h.uv;
  }
  Workspace workspace;
  CHECK_OK(system.Solve(right, 1, x, workspace));
  return x;
}

Result<GroundedSystem<Complex>> SpectralSystem(const Cells& cells, std::size_t vertices,
                                               const OrderSource& order,
                                               const std::function<void()>& assembled) {
  const std::vector<bool> none(vertices, false);
  Eigen::SparseMatrix<Complex> matrix = AssembleSimilarity(cells, none);
  if (assembled) assembled();
  const double shift = kShift * matrix.diagonal().real().mean();
  for (Eigen::Index v = 0; v < matrix.rows(); ++v) matrix.coeffRef(v, v) += shift;
  TRY(const Order found, order(matrix));
  auto system =
      GroundedSystem<Complex>::Make(std::move(matrix), none, FactorLayout::kPacked, found);
  if (system) system->set_raised(shift);
  return system;
}

Result<std::vector<Complex>> SpectralFirstStep(const GroundedSystem<Complex>& system,
                                               const Chart& chart,
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
      return Fail(FaultKind::kNumerical, "The boundary of the first step has no spread.");
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
    CHECK_OK(cancel.Check());
    last = spread;
    for (std::size_t v = 0; v < n; ++v) right[v] = kept * x[v] + energy * spread[v];
    const std::vector<Complex> asked = right;
    CHECK_OK(system.Solve(right, 1, x, workspace));
    energy = Dot(x, asked).real();  // xᴴ M x
  }

  LayAlong(chart, anchors, x);
  return x;
}

Result<std::vector<Complex>> LoosenedFirstStep(const GroundedSystem<Complex>& system,
                                               const Cells& cells, const Chart& chart,
                                               const std::array<std::uint32_t, 2>& anchors,
                                               std::vector<Complex> x, const CancelToken& cancel) {
  const std::size_t n = chart.mesh.vertices.size();
  const std::vector<std::uint32_t> boundary = Boundary(chart);
  std::vector<Complex> direction = x, right(n), spread(n), last;
  const Complex origin = x[anchors[0]], unit = x[anchors[1]] - origin;
  for (Complex& p : direction) p = (p - origin) / unit;
  const double energy = SimilarityForceAt(cells, direction).energy;
  if (!(energy > 0)) return x;  // developable: there is nothing better
  Workspace workspace;
  for (int step = 0;; ++step) {
    if (Normalise(boundary, x, spread) == 0) {
      return Fail(FaultKind::kNumerical, "The boundary of the first step has no spread.");
    }
    if (step > 0) {
      const Complex common = Dot(last, spread);
      double change = 0;
      for (const std::uint32_t v : boundary) change += std::norm(spread[v] - common * last[v]);
      if (change < kLoose * kLoose || step == kMaxLooseSteps) break;
    }
    CHECK_OK(cancel.Check());
    last = spread;
    // H x = spread: what the grounded solve leaves at its vertices the direction takes up.
    const Complex share = Dot(direction, spread) / energy;
    right = spread;
    std::fill(x.begin(), x.end(), Complex(0));
    CHECK_OK(system.Solve(right, 1, x, workspace));
    for (std::size_t v = 0; v < n; ++v) x[v] += share * direction[v];
  }
  LayAlong(chart, anchors, x);
  return x;
}

Result<std::optional<std::vector<Complex>>> PinnedFirstStep(
    const GroundedSystem<Complex>& system, const std::array<std::uint32_t, 2>& ground,
    const Cells& cells, const Held& pins, std::size_t vertices, const CancelToken& cancel) {
  return PinnedSolve(system, ground, cells, pins, vertices).Solve(cancel);
}

}  // namespace arap
