#include "core/sparse/packed_factor.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <numeric>
#include <utility>

#include <sys/mman.h>

#include "core/base/large_pages.h"

namespace arap {
namespace {

template <class Scalar>
constexpr std::size_t kNumbers = sizeof(Scalar) / sizeof(double);

double* Put(double* out, double x) {
  *out = x;
  return out + 1;
}
double* Put(double* out, std::complex<double> x) {
  out[0] = x.real();
  out[1] = x.imag();
  return out + 2;
}

// Rows that are put in order in one piece.
constexpr std::size_t kRowRange = std::size_t{1} << 14u;

// Writes the inverse of the lower triangle of a dense block, row by row.
template <class Scalar>
double* PutInverse(const Scalar* block, std::size_t stride, std::size_t width, double* out) {
  Scalar inverse[kPanelWidth][kPanelWidth];
  for (std::size_t i = 0; i < width; ++i) {
    const Scalar pivot = Scalar(1) / block[i * stride + i];
    for (std::size_t j = 0; j < i; ++j) {
      Scalar sum(0);
      for (std::size_t k = j; k < i; ++k) sum += block[k * stride + i] * inverse[k][j];
      inverse[i][j] = -sum * pivot;
      out = Put(out, inverse[i][j]);
    }
    inverse[i][i] = pivot;
    out = Put(out, pivot);
  }
  return out;
}

// Begins on a cache line. The numbers are not set to 0, because the system provides a page only when it is first written.
// Large arrays ask for large pages, because processors stop reading ahead at the end of each page.
double* AllocateNumbers(std::size_t count) {
  constexpr std::size_t kLine = 64, kLargePage = std::size_t{2} << 20u;
  const std::size_t bytes = count * sizeof(double);
  const std::size_t page = bytes < 2 * kLargePage ? kLine : kLargePage;
  const std::size_t size = (bytes + page - 1) / page * page;
  void* memory = std::aligned_alloc(page, std::max(size, kLine));
  if (memory == nullptr) throw std::bad_alloc();
  if (page == kLargePage) PreferLargePages(memory, size);
  return static_cast<double*>(memory);
}

// Gives whole pages behind the first `kept` of `allocated` numbers back to the system. Returns how many numbers stay at
// most, which does not depend on where the memory lies: budgets and reports of one mesh are always the same.
std::size_t KeepNumbers(const double* numbers, std::size_t kept, std::size_t allocated) {
  constexpr std::uintptr_t kPage = 4096, kLeast = 16 * kPage;
  // The pages at both ends may be shared with numbers that stay, or with other memory.
  constexpr std::size_t kEnds = 2 * kPage / sizeof(double);
  if ((allocated - kept) * sizeof(double) < kLeast + 2 * kPage) return allocated;
  const auto start = reinterpret_cast<std::uintptr_t>(numbers);
  const std::uintptr_t from = (start + kept * sizeof(double) + kPage - 1) / kPage * kPage,
                       to = (start + allocated * sizeof(double)) / kPage * kPage;
  if (madvise(reinterpret_cast<void*>(from), to - from, MADV_DONTNEED) != 0) return allocated;
  return kept + kEnds;
}

// The largest subtrees of the elimination tree that have at most `most` numbers, as ascending ranges of supernodes.
// Every supernode outside of them is an ancestor of some. CHOLMOD numbers the supernodes of a subtree consecutively; in
// an order that does not, fewer subtrees are found.
std::vector<PanelRange> SubtreesOf(const SupernodalPattern& l, std::size_t most) {
  const std::size_t count = l.first.size() - 1;
  std::vector<std::size_t> numbers(count), members(count, 1), lowest(count);
  std::iota(lowest.begin(), lowest.end(), std::size_t{0});
  for (std::size_t s = 0; s < count; ++s) {
    numbers[s] += static_cast<std::size_t>(l.values_begin[s + 1] - l.values_begin[s]);
    const int below = l.rows_begin[s] + l.first[s + 1] - l.first[s];
    if (below == l.rows_begin[s + 1]) continue;
    const int row = l.rows[static_cast<std::size_t>(below)];
    const auto parent = static_cast<std::size_t>(
        std::upper_bound(l.first.begin(), l.first.end(), row) - l.first.begin() - 1);
    numbers[parent] += numbers[s];
    members[parent] += members[s];
    lowest[parent] = std::min(lowest[parent], lowest[s]);
  }
  std::vector<PanelRange> subtrees;
  for (std::size_t end = count; end > 0;) {
    const std::size_t s = end - 1;
    const bool whole = numbers[s] <= most && lowest[s] + members[s] == end;
    if (whole) subtrees.push_back({lowest[s], end});
    end = whole ? lowest[s] : s;
  }
  std::reverse(subtrees.begin(), subtrees.end());
  return subtrees;
}

}  // namespace

template <class Scalar>
PackedFactor<Scalar>::PackedFactor(const SupernodalPattern& l, std::size_t part_numbers)
    : order_(l.order.begin(), l.order.end()) {
  const std::size_t count = l.first.size() - 1;
  std::vector<std::size_t> first_panel(count + 1);
  block_begin_.resize(count);
  std::size_t blocks = 0;
  // The last first: the pass from the root to the leaves is the one that is never cut short, and
  // reads forwards so.
  for (std::size_t s = count; s-- > 0;) {
    const auto first = static_cast<std::size_t>(l.first[s]),
               width = static_cast<std::size_t>(l.first[s + 1]) - first;
    const auto rows = static_cast<std::size_t>(l.rows_begin[s]),
               height = static_cast<std::size_t>(l.rows_begin[s + 1]) - rows;
    ForEachPanel(width, [&](std::size_t begin, std::size_t end) {
      panels_.panels.push_back({static_cast<std::uint32_t>(first + begin),
                                static_cast<std::uint32_t>(end - begin),
                                static_cast<std::uint32_t>(rows + end),
                                static_cast<std::uint32_t>(height - end), panels_.numbers});
      panels_.numbers += NumbersOf(end - begin, height - end);
    });
    first_panel[s] = panels_.panels.size();
    block_begin_[s] = static_cast<int>(blocks);
    blocks += width * height;
    // Rows of panels are filled up with zeros, so the panels so far may take more numbers than their blocks.
    if (panels_.numbers > room_ + blocks * kNumbers<Scalar>)
      room_ = panels_.numbers - blocks * kNumbers<Scalar>;
  }
  const std::size_t panels = panels_.panels.size();
  for (std::size_t& first : first_panel) first = panels - first;
  std::reverse(panels_.panels.begin(), panels_.panels.end());
  panels_.panels.shrink_to_fit();
  panels_.rows.assign(l.rows.begin(), l.rows.end());
  Cut(l, first_panel, part_numbers);
  room_ = (room_ + kAlign - 1) / kAlign * kAlign;
  allocated_ = room_ + blocks * kNumbers<Scalar>;
  panels_.values.reset(AllocateNumbers(allocated_));
}

template <class Scalar>
void PackedFactor<Scalar>::Pack(const SupernodalPattern& l) {
  std::vector<Scalar> copy;  // of a block that its own panels would overwrite
  std::size_t panel = panels_.panels.size();
  for (std::size_t s = l.first.size() - 1; s-- > 0;) {
    const auto first = static_cast<std::size_t>(l.first[s]);
    const auto height = static_cast<std::size_t>(l.rows_begin[s + 1] - l.rows_begin[s]);
    const std::size_t size = (static_cast<std::size_t>(l.first[s + 1]) - first) * height;
    std::size_t end = panel;
    while (panel > 0 && panels_.panels[panel - 1].first >= first) --panel;
    const std::size_t numbers_end = panel > 0 ? panels_.panels[panel - 1].values : panels_.numbers;
    const Scalar* block = blocks() + block_begin_[s];
    if (panels_.values.get() + numbers_end > reinterpret_cast<const double*>(block)) {
      copy.assign(block, block + size);
      block = copy.data();
    }
    while (end-- > panel)
      PackPanel(panels_.panels[end], block, panels_.panels[end].first - first, height);
  }
}

template <class Scalar>
void PackedFactor<Scalar>::GiveBackRoom() {
  allocated_ = KeepNumbers(panels_.values.get(), panels_.numbers, allocated_);
  block_begin_ = {};
}

// Calls visit(begin, end) for the columns of every panel of a supernode, the last panel first. Real panels are as wide as
// possible, because the rows of narrow ones are filled up with zeros; complex panels share the columns equally.
template <class Scalar>
template <class Visit>
void PackedFactor<Scalar>::ForEachPanel(std::size_t width, Visit visit) {
  constexpr std::size_t kColumns = kPanelWidth / kNumbers<Scalar>;
  const std::size_t panels = (width + kColumns - 1) / kColumns;
  for (std::size_t p = panels; p-- > 0;) {
    if constexpr (kNumbers<Scalar> == 1) {
      visit(p * kColumns, std::min((p + 1) * kColumns, width));
    } else {
      visit(p * width / panels, (p + 1) * width / panels);
    }
  }
}

template <class Scalar>
std::size_t PackedFactor<Scalar>::NumbersOf(std::size_t width, std::size_t rows) {
  if constexpr (kNumbers<Scalar> == 1) return Diagonal(width) + rows * Filled(width);
  return (width * (width + 1) / 2 + rows * width) * kNumbers<Scalar>;
}

template <class Scalar>
void PackedFactor<Scalar>::PackPanel(const Panel& panel, const Scalar* block, std::size_t begin,
                                     std::size_t height) {
  const std::size_t width = panel.width, end = begin + width;
  double* out = panels_.values.get() + panel.values;
  double* const next = out + NumbersOf(width, height - end);
  double* const below = PutInverse(block + begin * height + begin, height, width, out);
  std::size_t filled = width;
  if constexpr (kNumbers<Scalar> == 1) {
    filled = Filled(width);
    std::fill(below, next, 0.0);
    out += Diagonal(width);
  } else {
    out = below;
  }
  for (std::size_t r = end; r < height; ++r) {
    double* number = out;
    for (std::size_t c = begin; c < end; ++c) number = Put(number, block[c * height + r]);
    out += filled * kNumbers<Scalar>;
  }
}

template <class Scalar>
void PackedFactor<Scalar>::Cut(const SupernodalPattern& l, std::span<const std::size_t> first_panel,
                               std::size_t part_numbers) {
  const auto numbers = [&](const PanelRange& supernodes) {
    return static_cast<std::size_t>(l.values_begin[supernodes.end] -
                                    l.values_begin[supernodes.begin]);
  };
  const std::size_t count = l.first.size() - 1;
  std::vector<PanelRange> subtrees;
  if (numbers({0, count}) > 4 * part_numbers) subtrees = SubtreesOf(l, part_numbers);
  subtrees.push_back({count, count});
  std::size_t begin = 0, together = 0, done = 0;
  for (std::size_t i = 0; i < subtrees.size(); ++i) {
    const PanelRange& subtree = subtrees[i];
    if (done < subtree.begin) {
      panels_.top.push_back({first_panel[done], first_panel[subtree.begin]});
    }
    done = subtree.end;
    const bool last = i + 1 == subtrees.size();
    if (begin < i && (last || together + numbers(subtree) > part_numbers)) {
      AddPart(l, first_panel, std::span(subtrees).subspan(begin, i - begin));
      begin = i;
      together = 0;
    }
    together += numbers(subtree);
  }
}

template <class Scalar>
void PackedFactor<Scalar>::AddPart(const SupernodalPattern& l,
                                   std::span<const std::size_t> first_panel,
                                   std::span<const PanelRange> subtrees) {
  PanelPart part;
  part.copies = size() + panels_.copies;
  const auto for_each_above = [&](auto visit) {
    for (const PanelRange& subtree : subtrees) {
      const auto end = static_cast<std::uint32_t>(l.first[subtree.end]);
      const auto first_row = static_cast<std::size_t>(l.rows_begin[subtree.begin]),
                 end_row = static_cast<std::size_t>(l.rows_begin[subtree.end]);
      for (std::size_t r = first_row; r < end_row; ++r) {
        if (panels_.rows[r] >= end) visit(panels_.rows[r]);
      }
    }
  };
  for (const PanelRange& subtree : subtrees) {
    part.panels.push_back({first_panel[subtree.begin], first_panel[subtree.end]});
  }
  for_each_above([&](std::uint32_t row) { part.above.push_back(row); });
  std::sort(part.above.begin(), part.above.end());
  part.above.erase(std::unique(part.above.begin(), part.above.end()), part.above.end());
  part.above.shrink_to_fit();
  for_each_above([&](std::uint32_t& row) {
    const auto at = std::lower_bound(part.above.begin(), part.above.end(), row);
    row =
        static_cast<std::uint32_t>(part.copies + static_cast<std::size_t>(at - part.above.begin()));
  });
  panels_.copies += part.above.size();
  panels_.parts.push_back(std::move(part));
}

// Bytes do not depend on the crew: what a part takes from the rows of the top is added up in its copies, and these are
// added to the top in the order of the parts, also without a crew.
template <class Scalar>
void PackedFactor<Scalar>::TakeThrough(PackedKernel kernel, std::size_t numbers, double* x,
                                       Crew* crew) const {
  const std::vector<PanelPart>& parts = panels_.parts;
  RunParts(crew, parts.size(), [&](std::size_t p) {
    std::fill_n(x + parts[p].copies * numbers, parts[p].above.size() * numbers, 0.0);
    for (const PanelRange& range : parts[p].panels) kernel(panels_, range, true, x);
  });
  for (const PanelPart& part : parts) {
    const double* copy = x + part.copies * numbers;
    for (const std::uint32_t row : part.above) {
      for (std::size_t k = 0; k < numbers; ++k) x[row * numbers + k] += *copy++;
    }
  }
  const std::vector<PanelRange>& top = panels_.top;
  for (const PanelRange& range : top) kernel(panels_, range, true, x);
  for (std::size_t i = top.size(); i-- > 0;) kernel(panels_, top[i], false, x);
  RunParts(crew, parts.size(), [&](std::size_t p) {
    double* copy = x + parts[p].copies * numbers;
    for (const std::uint32_t row : parts[p].above) {
      copy = std::copy_n(x + row * numbers, numbers, copy);
    }
    for (std::size_t i = parts[p].panels.size(); i-- > 0;) {
      kernel(panels_, parts[p].panels[i], false, x);
    }
  });
}

template <class Scalar>
double* PackedFactor<Scalar>::Rows(std::span<double> scratch) const {
  void* memory = scratch.data();
  std::size_t space = scratch.size_bytes();
  return static_cast<double*>(std::align(
      kAlign * sizeof(double), 4 * (size() + panels_.copies) * sizeof(double), memory, space));
}

template <class Scalar>
void PackedFactor<Scalar>::Solve(const Scalar* right, std::size_t columns, Scalar* solution,
                                 std::span<double> scratch, Crew* crew,
                                 const PackedKernels& kernels) const {
  const std::size_t n = size();
  constexpr bool kComplex = kNumbers<Scalar> == 2;
  double* x = Rows(scratch);
  auto* rows = reinterpret_cast<Scalar*>(x);
  for (std::size_t first = 0; first < columns;) {
    // Columns that are taken together, and those that they are padded to.
    const std::size_t left = columns - first;
    const std::size_t take = std::min<std::size_t>(left, kComplex ? 2 : 4);
    const std::size_t lanes = kComplex ? take : take > 2 ? 4 : 2;
    // −0 becomes 0, or a number's sign could depend on its neighbours.
    RunRanges(crew, n, kRowRange, [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = 0; c < lanes; ++c) {
        const Scalar* column = c < take ? right + (first + c) * n : nullptr;
        for (std::size_t k = begin; k < end; ++k) {
          rows[k * lanes + c] =
              column ? column[static_cast<std::size_t>(order_[k])] + Scalar(0) : Scalar(0);
        }
      }
    });
    if constexpr (kComplex) {
      TakeThrough(lanes == 1 ? kernels.complex1 : kernels.complex2, 2 * lanes, x, crew);
    } else {
      TakeThrough(lanes == 2 ? kernels.real2 : kernels.real4, lanes, x, crew);
    }
    RunRanges(crew, n, kRowRange, [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = 0; c < take; ++c) {
        Scalar* column = solution + (first + c) * n;
        for (std::size_t k = begin; k < end; ++k) {
          column[static_cast<std::size_t>(order_[k])] = rows[k * lanes + c];
        }
      }
    });
    first += take;
  }
}

template <class Scalar>
void PackedFactor<Scalar>::SolvePoints(std::span<const PointSolve> shapes,
                                       std::span<double> scratch, Crew* crew,
                                       const PackedKernels& kernels) const {
  const std::size_t n = size(), count = shapes.size();
  double* x = Rows(scratch);
  auto* rows = reinterpret_cast<std::complex<double>*>(x);
  RunRanges(crew, n, kRowRange, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = 0; c < count; ++c) {
      const std::complex<double>* column = shapes[c].right;
      for (std::size_t k = begin; k < end; ++k) {
        rows[k * count + c] = column[static_cast<std::size_t>(order_[k])] + std::complex<double>(0);
      }
    }
  });
  TakeThrough(count == 1 ? kernels.real2 : kernels.real4, 2 * count, x, crew);
  RunRanges(crew, n, kRowRange, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = 0; c < count; ++c) {
      std::complex<double>* column = shapes[c].solution;
      for (std::size_t k = begin; k < end; ++k) {
        column[static_cast<std::size_t>(order_[k])] = rows[k * count + c];
      }
    }
  });
}

template <class Scalar>
std::size_t PackedFactor<Scalar>::bytes() const {
  return order_.size() * sizeof(int) + panels_.panels.size() * sizeof(Panel) +
         (panels_.rows.size() + panels_.copies) * sizeof(std::uint32_t) +
         block_begin_.size() * sizeof(int) + allocated_ * sizeof(double);
}

template class PackedFactor<double>;
template class PackedFactor<std::complex<double>>;

}  // namespace arap
