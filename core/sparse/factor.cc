#include "core/sparse/factor.h"

#include <algorithm>
#include <array>
#include <optional>
#include <type_traits>

#include <cholmod.h>

#include "core/base/cpu_timer.h"
#include "core/base/large_pages.h"
#include "core/base/try.h"
#include "core/sparse/cholmod_types.h"
#include "core/sparse/library_guards.h"
#include "core/sparse/packed_factor.h"
#include "core/sparse/supernodal.h"

namespace arap {
namespace {

// A simplicial solve works on blocks of 4 columns, leaves its buffer with the shape of the last
// block, and the next solve would allocate it anew because of that. Giving it its shape back keeps
// the memory.
void RestoreShape(cholmod_dense* y, std::size_t n) {
  if (y == nullptr || n == 0 || y->nzmax != 4 * n) return;
  y->nrow = y->d = 4;
  y->ncol = n;
}

// LDLᵗ goes on when a pivot is negative; the diagonal tells. LLᵗ has stopped by then.
bool HasPositivePivots(const cholmod_factor& f) {
  if (f.is_ll) return true;
  const std::size_t step = f.xtype == CHOLMOD_COMPLEX ? 2 : 1;
  const int* begin = static_cast<const int*>(f.p);
  const double* x = static_cast<const double*>(f.x);
  for (std::size_t j = 0; j < f.n; ++j) {
    if (!(x[static_cast<std::size_t>(begin[j]) * step] > 0)) return false;
  }
  return true;
}

int CholmodMode(FactorLayout layout) {
  switch (layout) {
    case FactorLayout::kSupernodal:
      return CHOLMOD_AUTO;
    case FactorLayout::kSimplicial:
      return CHOLMOD_SIMPLICIAL;
    case FactorLayout::kPacked:
      return CHOLMOD_SUPERNODAL;
  }
  return CHOLMOD_AUTO;
}

SupernodalPattern PatternOf(const cholmod_factor& f) {
  return {Indices(f.super, f.nsuper + 1), Indices(f.pi, f.nsuper + 1), Indices(f.s, f.ssize),
          Indices(f.px, f.nsuper + 1), Indices(f.Perm, f.n)};
}

// Fills a factor that was analysed with the numbers of a matrix; CHOLMOD's status. Its own code for supernodes
// takes twice as long as ours.
template <class Scalar>
int Numbers(const Eigen::SparseMatrix<Scalar>& lower, cholmod_factor& f, cholmod_common& common) {
  if (!f.is_super) {
    cholmod_sparse matrix = CholmodView(lower);
    const NoOpenMp alone;
    cholmod_factorize(&matrix, &f, &common);
    if (common.status != CHOLMOD_OK) return common.status;
    return f.minor == f.n && HasPositivePivots(f) ? CHOLMOD_OK : CHOLMOD_NOT_POSDEF;
  }
  // The first time there is no room for numbers yet.
  if (f.xtype == CHOLMOD_PATTERN) {
    if (!cholmod_change_factor(kXtype<Scalar>, 1, 1, 1, 1, &f, &common)) return common.status;
    PreferLargePages(f.x, f.xsize * sizeof(Scalar));
  }
  const bool definite = FactorSupernodes<Scalar>(PatternOf(f), lower, static_cast<Scalar*>(f.x));
  f.minor = definite ? f.n : 0;
  return definite ? CHOLMOD_OK : CHOLMOD_NOT_POSDEF;
}

// The same for a packed factor with the pattern of `f`. Writes the dense blocks; Pack must follow, which makes panels of
// them.
template <class Scalar>
int Numbers(const Eigen::SparseMatrix<Scalar>& lower, const cholmod_factor& f,
            std::optional<PackedFactor<Scalar>>& packed) {
  SupernodalPattern pattern = PatternOf(f);
  if (!packed) packed.emplace(pattern);
  pattern.values_begin = packed->block_begin();
  if (!FactorSupernodes<Scalar>(pattern, lower, packed->blocks())) {
    packed.reset();
    return CHOLMOD_NOT_POSDEF;
  }
  return CHOLMOD_OK;
}

}  // namespace

class FactorData {
 public:
  ~FactorData() { DropCholmod(); }
  void DropCholmod() { cholmod_free_factor(&factor, common.get()); }

  template <class Scalar>
  auto& packed() {
    if constexpr (std::is_same_v<Scalar, double>) {
      return real;
    } else {
      return complex;
    }
  }

  CholmodCommon common;
  FactorLayout layout = FactorLayout::kSupernodal;
  // Of a packed factor it has the pattern alone, and is dropped when there will be no further matrix.
  cholmod_factor* factor = nullptr;
  // If the factor is packed, the one of its scalar type.
  std::optional<PackedFactor<double>> real;
  std::optional<PackedFactor<std::complex<double>>> complex;
};

class Workspace::Data {
 public:
  // CHOLMOD keeps these between calls and grows them when needed. One set per scalar type, because
  // a change of type frees and allocates.
  struct Buffers {
    cholmod_dense *x = nullptr, *y = nullptr, *e = nullptr;
  };
  ~Data() {
    for (Buffers* b : {&real, &complex}) {
      cholmod_free_dense(&b->x, common.get());
      cholmod_free_dense(&b->y, common.get());
      cholmod_free_dense(&b->e, common.get());
    }
  }
  // Returns memory for the solutions of so many shapes, and makes sure that there is scratch for solving.
  std::complex<double>* Points(const PackedFactor<double>& factor, std::size_t shapes) {
    if (x.size() < 2 * factor.size() * shapes) x.resize(2 * factor.size() * shapes);
    if (lanes.size() < factor.ScratchSize()) lanes.resize(factor.ScratchSize());
    return reinterpret_cast<std::complex<double>*>(x.data());
  }
  CholmodCommon common;
  Buffers real, complex;
  // Of packed factors: the answer, and rows of a few columns together.
  std::vector<double> x, lanes;
};

Workspace::Workspace() : data_(std::make_unique<Data>()) {}
Workspace::~Workspace() = default;
Workspace::Workspace(Workspace&&) noexcept = default;
Workspace& Workspace::operator=(Workspace&&) noexcept = default;

template <class Scalar>
Factor<Scalar>::Factor(std::unique_ptr<FactorData> data) : data_(std::move(data)) {}
template <class Scalar>
Factor<Scalar>::~Factor() = default;

template <class Scalar>
Result<std::unique_ptr<Factor<Scalar>>> Factor<Scalar>::Analyse(
    const Eigen::SparseMatrix<Scalar>& lower, FactorLayout layout, std::span<const int> order) {
  UseOneBlasThread();
  CpuTimer timer;
  auto data = std::make_unique<FactorData>();
  cholmod_common* common = data->common.get();
  data->layout = layout;
  common->supernodal = CholmodMode(layout);
  common->final_ll = 0;
  common->nmethods = 1;
  common->method[0].ordering = order.empty() ? CHOLMOD_AMD : CHOLMOD_GIVEN;
  if (layout != FactorLayout::kSimplicial) {
    // Supernodes of fewer columns than BLAS needs: a fifth less numbers to read in every solve.
    common->nrelax[0] = 2, common->nrelax[1] = 8, common->nrelax[2] = 32;
  }
  constexpr Eigen::Index kMany = 40'000;
  if (layout == FactorLayout::kSupernodal && lower.rows() > kMany) {
    // Large factors that are not packed have narrower supernodes still, which saves 7 % of their memory. Small factors lie
    // in the caches, where narrower supernodes would take 9 % more time.
    common->nrelax[0] = 1, common->nrelax[1] = 4, common->nrelax[2] = 16;
    common->zrelax[0] = 0.5, common->zrelax[1] = 0.05, common->zrelax[2] = 0.01;
  }
  cholmod_sparse matrix = CholmodView(lower);
  const NoOpenMp alone;
  // cholmod_analyze_p does not write to the permutation.
  int* given = order.empty() ? nullptr : const_cast<int*>(order.data());
  data->factor = cholmod_analyze_p(&matrix, given, nullptr, 0, common);
  if (!data->factor || common->status != CHOLMOD_OK) {
    return Fail(CholmodFault(common->status, "Analysing", matrix.nrow));
  }
  std::unique_ptr<Factor> factor(new Factor(std::move(data)));
  factor->times_.analysis = timer.Lap();
  return factor;
}

template <class Scalar>
Status Factor<Scalar>::Again(const Eigen::SparseMatrix<Scalar>& lower) {
  CpuTimer timer;
  const bool packed = data_->layout == FactorLayout::kPacked;
  {
    [[maybe_unused]] const NoDenormals none;
    const int status = packed ? Numbers(lower, *data_->factor, data_->packed<Scalar>())
                              : Numbers(lower, *data_->factor, *data_->common.get());
    if (status != CHOLMOD_OK) return Fail(CholmodFault(status, "Factoring", size()));
  }
  times_.numbers = timer.Lap();
  if (packed) data_->packed<Scalar>()->Pack(PatternOf(*data_->factor));
  return {};
}

template <class Scalar>
Result<std::shared_ptr<const Factor<Scalar>>> Factor<Scalar>::Make(
    const Eigen::SparseMatrix<Scalar>& lower, FactorLayout layout, std::span<const int> order) {
  TRY(auto factor, Analyse(lower, layout, order));
  cholmod_free_work(factor->data_->common.get());  // supernodes need none
  CHECK_OK(factor->Again(lower));
  if (layout == FactorLayout::kPacked) {
    factor->data_->template packed<Scalar>()->GiveBackRoom();
    factor->data_->DropCholmod();
  }
  cholmod_free_work(factor->data_->common.get());  // solves have workspaces of their own
  return std::shared_ptr<const Factor>(std::move(factor));
}

template <class Scalar>
Result<std::span<const Scalar>> Factor<Scalar>::Solve(std::span<const Scalar> right,
                                                      std::size_t columns, Workspace& workspace,
                                                      Crew* crew) const {
  Workspace::Data& scratch = workspace.data();
  if (const auto& packed = data_->packed<Scalar>()) {
    const std::size_t count = size() * columns, numbers = count * sizeof(Scalar) / sizeof(double);
    if (scratch.x.size() < numbers) scratch.x.resize(numbers);
    if (scratch.lanes.size() < packed->ScratchSize()) scratch.lanes.resize(packed->ScratchSize());
    // A complex number is two doubles in a row, says the standard.
    auto* x = reinterpret_cast<Scalar*>(scratch.x.data());
    packed->Solve(right.data(), columns, x, scratch.lanes, crew);
    return std::span<const Scalar>(x, count);
  }
  auto& buffers = kXtype<Scalar> == CHOLMOD_REAL ? scratch.real : scratch.complex;
  cholmod_dense view{};
  view.nrow = view.d = size();
  view.ncol = columns;
  view.nzmax = size() * columns;
  view.x = const_cast<Scalar*>(right.data());  // read only
  view.xtype = kXtype<Scalar>;
  view.dtype = CHOLMOD_DOUBLE;
  if (!data_->factor->is_super) RestoreShape(buffers.y, size());
  const NoOpenMp alone;
  const int ok = cholmod_solve2(CHOLMOD_A, data_->factor, &view, nullptr, &buffers.x, nullptr,
                                &buffers.y, &buffers.e, scratch.common.get());
  if (!ok) return Fail(CholmodFault(scratch.common.get()->status, "Solving for", size()));
  return std::span(static_cast<const Scalar*>(buffers.x->x), size() * columns);
}

template <class Scalar>
std::span<const std::complex<double>> Factor<Scalar>::SolvePoints(
    std::span<const std::complex<double>> right, std::size_t shapes, Workspace& workspace,
    Crew* crew) const {
  const PackedFactor<double>& packed = *data_->real;
  const std::size_t n = packed.size();
  std::complex<double>* x = workspace.data().Points(packed, shapes);
  for (std::size_t begin = 0; begin < shapes; begin += 2) {
    const std::size_t next = std::min(begin + 1, shapes - 1);
    const std::array<PointSolve, 2> pair{PointSolve{right.data() + begin * n, x + begin * n},
                                         PointSolve{right.data() + next * n, x + next * n}};
    packed.SolvePoints(std::span(pair).first(next - begin + 1), workspace.data().lanes, crew);
  }
  return {x, n * shapes};
}

template <class Scalar>
std::pair<std::span<const std::complex<double>>, std::span<const std::complex<double>>>
Factor<Scalar>::SolveBoth(std::span<const std::complex<double>> one, Workspace& ones,
                          std::span<const std::complex<double>> other, Workspace& others,
                          Crew* crew) const {
  const PackedFactor<double>& packed = *data_->real;
  const std::size_t n = packed.size();
  std::complex<double>* x = ones.data().Points(packed, 1);
  std::complex<double>* y = others.data().Points(packed, 1);
  const std::array<PointSolve, 2> both{PointSolve{one.data(), x}, PointSolve{other.data(), y}};
  packed.SolvePoints(both, ones.data().lanes, crew);
  return {std::span<const std::complex<double>>(x, n), std::span<const std::complex<double>>(y, n)};
}

template <class Scalar>
std::size_t Factor<Scalar>::size() const {
  return order().size();
}

template <class Scalar>
std::span<const int> Factor<Scalar>::order() const {
  if (const auto& packed = data_->packed<Scalar>()) return packed->order();
  return {static_cast<const int*>(data_->factor->Perm), data_->factor->n};
}

template <class Scalar>
std::size_t Factor<Scalar>::bytes() const {
  const auto& packed = data_->packed<Scalar>();
  std::size_t bytes = sizeof(FactorData) + (packed ? packed->bytes() : 0);
  if (data_->factor) {
    const cholmod_factor& f = *data_->factor;
    const std::size_t numbers = packed ? 0 : f.is_super ? f.xsize : f.nzmax;
    const std::size_t indices = f.is_super ? f.ssize : f.nzmax;
    bytes += numbers * sizeof(Scalar) + indices * sizeof(int) + f.n * 8 * sizeof(int);
  }
  return bytes;
}

template class Factor<double>;
template class Factor<std::complex<double>>;

}  // namespace arap
