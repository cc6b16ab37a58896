// The passes over all cells, with a crew and without.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/base/lanes.h"
#include "core/energy/local_step.h"

namespace arap {
namespace {

Complex FallbackFor(Complex mean) { return mean == 0.0 ? 1.0 : mean; }

// A complex number is two doubles in a row, says the standard.
const double* NumbersAt(std::span<const Complex> points) {
  return reinterpret_cast<const double*>(points.data());
}
double* NumbersAt(std::span<Complex> points) { return reinterpret_cast<double*>(points.data()); }

// Calls visit(begin, count, component) for blocks of at most kKernelBlock cells of one component, those that begin with
// a cell of [begin, end).
template <class Visit>
void ForEachKernelBlock(const std::vector<CellRun>& runs, std::size_t begin, std::size_t end,
                        Visit visit) {
  auto run = std::partition_point(runs.begin(), runs.end(),
                                  [&](const CellRun& each) { return each.end <= begin; });
  for (; run != runs.end() && run->begin < end; ++run) {
    std::size_t at = run->begin;
    if (at < begin) at += (begin - at + kKernelBlock - 1) / kKernelBlock * kKernelBlock;
    for (; at < run->end && at < end; at += kKernelBlock) {
      visit(at, std::min(kKernelBlock, run->end - at), run->component);
    }
  }
}

// How the forces of a block of cells are computed, which `kPairs` of numbers a cell has, and how they are added.
struct HingeForce {
  static constexpr std::size_t kPairs = 1;
  struct Columns {
    KernelColumn x, y;
  };
  const LocalKernels& kernels;
  const HingeTable& table;
  const double* shape;
  std::span<const Complex> mean;

  void Compute(std::size_t at, std::size_t count, std::uint32_t component, Columns& c) const {
    const Complex middle = mean[component];
    kernels.hinge_forces(table, at, count, shape, middle, FallbackFor(middle), c.x, c.y);
  }
  static void Read(const Columns& c, std::size_t k, Pair* own) { own[0] = Pair{c.x[k], c.y[k]}; }
  void Add(std::size_t cell, const Pair* own, double* force) const {
    PointAt<PointsBy::kBegin>(force, table.j[cell]) += own[0];
    PointAt<PointsBy::kBegin>(force, table.i[cell]) -= own[0];
  }
};

struct FaceForce {
  static constexpr std::size_t kPairs = 2;
  struct Columns {
    KernelColumn x1, y1, x2, y2;
  };
  const LocalKernels& kernels;
  const FaceTable& table;
  const double* shape;
  std::span<const Complex> mean;

  void Compute(std::size_t at, std::size_t count, std::uint32_t component, Columns& c) const {
    const Complex middle = mean[component];
    kernels.face_forces(table, at, count, shape, middle, FallbackFor(middle), c.x1, c.y1, c.x2,
                        c.y2);
  }
  static void Read(const Columns& c, std::size_t k, Pair* own) {
    own[0] = Pair{c.x1[k], c.y1[k]};
    own[1] = Pair{c.x2[k], c.y2[k]};
  }
  void Add(std::size_t cell, const Pair* own, double* force) const {
    PointAt<PointsBy::kNumber>(force, table.v0[cell]) -= own[0] + own[1];
    PointAt<PointsBy::kNumber>(force, table.v1[cell]) += own[0];
    PointAt<PointsBy::kNumber>(force, table.v2[cell]) += own[1];
  }
};

// Cells whose forces are computed while those before them are added, and how many of them at a time in one thread.
constexpr std::size_t kTurn = std::size_t{1} << 15u, kSlice = std::size_t{1} << 12u;
constexpr std::size_t kRoom = 2 * (kTurn + kKernelBlock) * 2 * FaceForce::kPairs;

// With a crew.
template <class Kind>
void AddInTurns(const Kind& kind, std::size_t cells, double* force, Crew* crew,
                std::vector<double>& room) {
  const std::vector<CellRun>& runs = kind.table.runs;
  if (room.size() < kRoom) room.resize(kRoom);
  // A turn's forces in one half, those of the turn before it in the other. A block belongs to the turn and the slice
  // in which it begins, and goes a little beyond.
  const auto forces_of = [&](std::size_t turn, std::size_t cell) {
    return &PointAt<PointsBy::kNumber>(
        room.data() + (turn % 2) * (kRoom / 2),
        static_cast<std::int32_t>((cell - turn * kTurn) * Kind::kPairs));
  };
  const std::size_t turns = (cells + kTurn - 1) / kTurn;
  for (std::size_t turn = 0; turn <= turns; ++turn) {
    const std::size_t begin = turn * kTurn, end = std::min(cells, begin + kTurn);
    const std::size_t slices = turn < turns ? (end - begin + kSlice - 1) / kSlice : 0;
    const std::size_t adds = turn > 0 ? 1 : 0;
    RunParts(crew, slices + adds, [&](std::size_t part) {
      if (part < adds) {
        ForEachKernelBlock(runs, begin - kTurn, std::min(cells, begin),
                           [&](std::size_t at, std::size_t count, std::uint32_t) {
                             const Pair* own = forces_of(turn - 1, at);
                             for (std::size_t k = 0; k < count; ++k, own += Kind::kPairs) {
                               kind.Add(at + k, own, force);
                             }
                           });
        return;
      }
      typename Kind::Columns columns;
      const std::size_t from = begin + (part - adds) * kSlice;
      ForEachKernelBlock(runs, from, std::min(end, from + kSlice),
                         [&](std::size_t at, std::size_t count, std::uint32_t component) {
                           kind.Compute(at, count, component, columns);
                           Pair* own = forces_of(turn, at);
                           for (std::size_t k = 0; k < count; ++k, own += Kind::kPairs) {
                             Kind::Read(columns, k, own);
                           }
                         });
    });
  }
}

template <class Kind>
void AddForces(const Kind& kind, double* force, Crew* crew, std::vector<double>& room) {
  const std::vector<CellRun>& runs = kind.table.runs;
  const std::size_t cells = runs.empty() ? 0 : runs.back().end;
  if (crew != nullptr) return AddInTurns(kind, cells, force, crew, room);
  typename Kind::Columns columns;
  ForEachKernelBlock(runs, 0, cells,
                     [&](std::size_t at, std::size_t count, std::uint32_t component) {
                       kind.Compute(at, count, component, columns);
                       for (std::size_t k = 0; k < count; ++k) {
                         Pair own[Kind::kPairs];
                         Kind::Read(columns, k, own);
                         kind.Add(at + k, own, force);
                       }
                     });
}

// Adds up block by block, and parts of some ten thousand cells apart, with a crew or without.
template <class Energy>
double EnergyOf(const std::vector<CellRun>& runs, Crew* crew, Energy energy) {
  constexpr std::size_t kLeast = std::size_t{1} << 16u;
  const std::size_t cells = runs.empty() ? 0 : runs.back().end;
  const std::size_t size = PartSize(cells, kLeast), parts = (cells + size - 1) / size;
  std::array<double, kMostParts> sums;
  RunParts(crew, parts, [&](std::size_t p) {
    double sum = 0;
    ForEachKernelBlock(runs, p * size, (p + 1) * size,
                       [&](std::size_t at, std::size_t count, std::uint32_t) {
                         double block = 0;
                         energy(at, count, block);
                         sum += block;
                       });
    sums[p] = sum;
  });
  double all = 0;
  for (std::size_t p = 0; p < parts; ++p) all += sums[p];
  return all;
}

Complex Difference(std::span<const Complex> v, const Spoke& s) { return v[s.b] - v[s.a]; }

std::span<const Spoke> SpokesOf(const StarTable& table, std::size_t s) {
  return std::span(table.spokes).subspan(table.begin[s], table.begin[s + 1] - table.begin[s]);
}

Complex TurnOf(const StarTable& table, std::size_t s, std::span<const Complex> v,
               Complex fallback) {
  Complex t = 0;
  for (const Spoke& spoke : SpokesOf(table, s)) {
    t += spoke.weight * (std::conj(spoke.rest) * Difference(v, spoke));
  }
  const double size = std::sqrt(std::norm(t));
  return size > kNoDirection * table.size_of[s] ? t * (1 / size) : fallback;
}

void AddStars(const StarTable& table, std::span<const Complex> v, std::span<const Complex> mean,
              std::span<Complex> f) {
  for (const CellRun& run : table.runs) {
    const Complex middle = mean[run.component];
    for (std::size_t s = run.begin; s < run.end; ++s) {
      const Complex turn = TurnOf(table, s, v, FallbackFor(middle)) - middle;
      for (const Spoke& spoke : SpokesOf(table, s)) {
        const Complex g = spoke.weight * (turn * spoke.rest);
        f[spoke.b] += g;
        f[spoke.a] -= g;
      }
    }
  }
}

double StarEnergy(const StarTable& table, std::span<const Complex> v) {
  double energy = 0;
  for (std::size_t s = 0; s < table.size(); ++s) {
    const Complex turn = TurnOf(table, s, v, 1);
    for (const Spoke& spoke : SpokesOf(table, s)) {
      energy += spoke.weight * std::norm(Difference(v, spoke) - turn * spoke.rest);
    }
  }
  return energy;
}

}  // namespace

void AddRotatedEdges(const Cells& cells, std::span<const Complex> shape,
                     std::span<const Complex> mean, std::span<Complex> force) {
  std::vector<double> none;
  AddRotatedEdges(cells, shape, mean, force, nullptr, none);
}

void AddRotatedEdges(const Cells& cells, std::span<const Complex> shape,
                     std::span<const Complex> mean, std::span<Complex> force, Crew* crew,
                     std::vector<double>& room) {
  const LocalKernels& kernels = LocalKernelsHere().back();
  double* numbers = NumbersAt(force);
  AddForces(HingeForce{kernels, cells.hinges, NumbersAt(shape), mean}, numbers, crew, room);
  AddForces(FaceForce{kernels, cells.faces, NumbersAt(shape), mean}, numbers, crew, room);
  AddStars(cells.stars, shape, mean, force);
}

double RigidEnergy(const Cells& cells, std::span<const Complex> shape, Crew* crew) {
  const LocalKernels& kernels = LocalKernelsHere().back();
  const double* numbers = NumbersAt(shape);
  const double hinges =
      EnergyOf(cells.hinges.runs, crew, [&](std::size_t at, std::size_t count, double& block) {
        kernels.hinge_energy(cells.hinges, at, count, numbers, block);
      });
  const double faces =
      EnergyOf(cells.faces.runs, crew, [&](std::size_t at, std::size_t count, double& block) {
        kernels.face_energy(cells.faces, at, count, numbers, block);
      });
  return hinges + faces + StarEnergy(cells.stars, shape);
}

}  // namespace arap
