#include "core/energy/assemble.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/sparse/lower_sum.h"

namespace arap {
namespace {

// A vector of at most `kMost` that allocates nothing.
template <class T, std::size_t kMost>
class Few {
 public:
  void clear() { size_ = 0; }
  void push_back(const T& value) { values_[size_++] = value; }
  void assign(std::size_t count, const T& value) {
    size_ = count;
    std::fill(begin(), end(), value);
  }
  template <class Iterator>
  void assign(Iterator first, Iterator last) {
    size_ = static_cast<std::size_t>(std::copy(first, last, begin()) - begin());
  }
  std::size_t size() const { return size_; }
  T* begin() { return values_.data(); }
  T* end() { return values_.data() + size_; }
  T* data() { return values_.data(); }
  const T* data() const { return values_.data(); }
  T& operator[](std::size_t i) { return values_[i]; }
  const T& operator[](std::size_t i) const { return values_[i]; }

 private:
  std::size_t size_ = 0;
  std::array<T, kMost> values_;
};

// The residuals (v_b − v_a) − t(v) e of one or a few cells, as rows over the vertices they touch.
template <class Ids, class Numbers, class Weights>
class BlockOf {
 public:
  void Start(std::span<const std::uint32_t> vertices) {
    vertices_.assign(vertices.begin(), vertices.end());
    rows_.clear();
    weights_.clear();
  }
  // A cell begins: its similarity is Σ of what Fit adds.
  void StartCell() { similarity_.assign(vertices_.size(), 0); }
  void Fit(std::size_t a, std::size_t b, Complex g) {
    similarity_[b] += g;
    similarity_[a] -= g;
  }
  void Compare(std::size_t a, std::size_t b, Complex rest, double weight) {
    if (weight == 0) return;
    weights_.push_back(weight);
    for (const Complex h : similarity_) rows_.push_back(-h * rest);
    Complex* row = rows_.data() + (rows_.size() - vertices_.size());
    row[b] += 1;
    row[a] -= 1;
  }

  std::span<const std::uint32_t> vertices() const { return {vertices_.data(), vertices_.size()}; }
  std::size_t rows() const { return weights_.size(); }
  double weight(std::size_t row) const { return weights_[row]; }
  const Complex* row(std::size_t r) const { return rows_.data() + r * vertices_.size(); }

 private:
  Ids vertices_;
  Numbers rows_, similarity_;
  Weights weights_;
};
using StarBlock = BlockOf<std::vector<std::uint32_t>, std::vector<Complex>, std::vector<double>>;
// Of a hinge or a face.
using SmallBlock = BlockOf<Few<std::uint32_t, 4>, Few<Complex, 9>, Few<double, 3>>;

std::uint32_t Id(std::int32_t vertex) { return static_cast<std::uint32_t>(vertex); }
// Of a vertex of a hinge.
std::uint32_t IdAt(std::int32_t begin) { return static_cast<std::uint32_t>(begin) / 2; }

void FillHinge(const HingeTable& table, std::size_t h, SmallBlock& block) {
  const bool boundary = table.right[h] == table.j[h];
  const std::array<std::uint32_t, 4> ids{IdAt(table.i[h]), IdAt(table.j[h]), IdAt(table.left[h]),
                                         IdAt(table.right[h])};
  const std::size_t corners = boundary ? 3 : 4;
  const std::array<Complex, 4> p{0, Complex(table.along_x[h], table.along_y[h]),
                                 Complex(table.left_x[h], table.left_y[h]),
                                 Complex(table.right_x[h], table.right_y[h])};
  block.Start(std::span(ids).first(corners));
  for (std::size_t from = 0; from < (table.both ? 2u : 1u); ++from) {
    double size = 0;
    for (std::size_t k = 0; k < corners; ++k) size += std::norm(p[k] - p[from]);
    block.StartCell();
    for (std::size_t k = 0; k < corners; ++k) {
      if (k != from) block.Fit(from, k, std::conj(p[k] - p[from]) / size);
    }
    block.Compare(from, 1 - from, p[1 - from] - p[from], table.weight[h]);
  }
}

// A face as a block, with what is known of it in advance: three corners, three residuals.
class FaceBlock {
 public:
  FaceBlock(const FaceTable& table, std::size_t t)
      : ids_{Id(table.v0[t]), Id(table.v1[t]), Id(table.v2[t])},
        weights_{table.weight0[t], table.weight1[t], table.weight2[t]} {
    const Complex to_1(table.e1_x[t], table.e1_y[t]), to_2(table.e2_x[t], table.e2_y[t]);
    const std::array<Complex, 3> side{to_2 - to_1, Complex(0) - to_2, to_1};  // opposite corner k
    double size = 0;
    for (std::size_t k = 0; k < 3; ++k) size += weights_[k] * std::norm(side[k]);
    std::array<Complex, 3> similarity{};
#pragma GCC unroll 3
    for (std::size_t k = 0; k < 3; ++k) {
      const Complex g = weights_[k] * std::conj(side[k]) / size;
      similarity[(k + 2) % 3] += g;
      similarity[(k + 1) % 3] -= g;
    }
#pragma GCC unroll 3
    for (std::size_t k = 0; k < 3; ++k) {
#pragma GCC unroll 3
      for (std::size_t i = 0; i < 3; ++i) rows_[k][i] = -similarity[i] * side[k];
      rows_[k][(k + 2) % 3] += 1;
      rows_[k][(k + 1) % 3] -= 1;
    }
  }

  // Adds its part of the matrix.
  void AddTo(LowerSum<Complex>& sum) const {
#pragma GCC unroll 3
    for (std::size_t i = 0; i < 3; ++i) {
      double own = 0;
#pragma GCC unroll 3
      for (std::size_t k = 0; k < 3; ++k) {
        if (weights_[k] != 0) own += weights_[k] * std::norm(rows_[k][i]);
      }
      sum.Add(ids_[i], ids_[i], own);
#pragma GCC unroll 3
      for (std::size_t j = 0; j < i; ++j) {
        Complex product = 0;
#pragma GCC unroll 3
        for (std::size_t k = 0; k < 3; ++k) {
          if (weights_[k] != 0) product += weights_[k] * (std::conj(rows_[k][i]) * rows_[k][j]);
        }
        if (ids_[i] > ids_[j]) {
          sum.Add(ids_[i], ids_[j], product);
        } else {
          sum.Add(ids_[j], ids_[i], std::conj(product));
        }
      }
    }
  }

 private:
  std::array<std::uint32_t, 3> ids_;
  std::array<double, 3> weights_;
  std::array<std::array<Complex, 3>, 3> rows_;
};

void FillFace(const FaceTable& table, std::size_t t, SmallBlock& block) {
  block.Start(std::array<std::uint32_t, 3>{Id(table.v0[t]), Id(table.v1[t]), Id(table.v2[t])});
  const std::array<Complex, 3> p{0, Complex(table.e1_x[t], table.e1_y[t]),
                                 Complex(table.e2_x[t], table.e2_y[t])};
  const std::array<double, 3> w{table.weight0[t], table.weight1[t], table.weight2[t]};
  double size = 0;
  for (std::size_t k = 0; k < 3; ++k) size += w[k] * std::norm(p[(k + 2) % 3] - p[(k + 1) % 3]);
  block.StartCell();
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t a = (k + 1) % 3, b = (k + 2) % 3;
    block.Fit(a, b, w[k] * std::conj(p[b] - p[a]) / size);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t a = (k + 1) % 3, b = (k + 2) % 3;
    block.Compare(a, b, p[b] - p[a], w[k]);
  }
}

std::span<const Spoke> SpokesOf(const StarTable& table, std::size_t s) {
  return std::span(table.spokes).subspan(table.begin[s], table.begin[s + 1] - table.begin[s]);
}

void FillStar(const StarTable& table, std::size_t s, StarBlock& block) {
  const auto spokes = SpokesOf(table, s);
  std::vector<std::uint32_t> ids{spokes.front().a};
  for (const Spoke& spoke : spokes) ids.push_back(spoke.b);
  block.Start(ids);
  block.StartCell();
  for (std::size_t k = 0; k < spokes.size(); ++k) {
    block.Fit(0, k + 1, spokes[k].weight * std::conj(spokes[k].rest) / table.size_of[s]);
  }
  for (std::size_t k = 0; k < spokes.size(); ++k) {
    block.Compare(0, k + 1, spokes[k].rest, spokes[k].weight);
  }
}

// Stars with more spokes are not made as a block: it has k³ sums for k spokes.
constexpr std::size_t kLargeStar = 64;

// Calls add(row vertex, column vertex, value) for the lower triangle of a star's matrix, of which
// there is a formula: Σ w |d|² − |Σ w ē d|² / Σ w |e|² for spokes e and their deformed vectors d.
template <class Add>
void AddLargeStar(const StarTable& table, std::size_t s, Add add) {
  const auto spokes = SpokesOf(table, s);
  const std::uint32_t middle = spokes.front().a;
  double weight = 0;
  Complex sum = 0;
  std::vector<std::pair<std::uint32_t, Complex>> fit;  // Σ w ē d as a sum over vertices
  for (const Spoke& spoke : spokes) {
    const Complex g = spoke.weight * std::conj(spoke.rest);
    fit.emplace_back(spoke.b, g);
    sum += g;
    weight += spoke.weight;
    add(spoke.b, spoke.b, Complex(spoke.weight));
    add(std::max(spoke.b, middle), std::min(spoke.b, middle), Complex(-spoke.weight));
  }
  fit.emplace_back(middle, -sum);
  add(middle, middle, Complex(weight));
  for (const auto& [p, of_p] : fit) {
    for (const auto& [q, of_q] : fit) {
      if (q > p) continue;
      const Complex square = p == q ? Complex(std::norm(of_p)) : std::conj(of_p) * of_q;
      add(p, q, square * (-1 / table.size_of[s]));
    }
  }
}

template <class Visit>
void ForEachHinge(const HingeTable& hinges, Visit visit) {
  SmallBlock block;
  for (std::size_t h = 0; h < hinges.size(); ++h) {
    FillHinge(hinges, h, block);
    visit(block);
  }
}

template <class Visit>
void ForEachStar(const Cells& cells, Visit visit, std::size_t most_spokes = SIZE_MAX) {
  StarBlock star;
  for (std::size_t s = 0; s < cells.stars.size(); ++s) {
    if (SpokesOf(cells.stars, s).size() > most_spokes) continue;
    FillStar(cells.stars, s, star);
    visit(star);
  }
}

template <class Visit>
void ForEachBlock(const Cells& cells, Visit visit) {
  ForEachHinge(cells.hinges, visit);
  SmallBlock block;
  for (std::size_t t = 0; t < cells.faces.size(); ++t) {
    FillFace(cells.faces, t, block);
    visit(block);
  }
  ForEachStar(cells, visit);
}

// Calls visit(a, b, weight) for every energy edge.
template <class Visit>
void ForEachEnergyEdge(const Cells& cells, Visit visit) {
  const HingeTable& h = cells.hinges;
  for (std::size_t k = 0; k < h.size(); ++k) {
    visit(IdAt(h.i[k]), IdAt(h.j[k]), h.both ? 2 * h.weight[k] : h.weight[k]);
  }
  const FaceTable& f = cells.faces;
  for (std::size_t t = 0; t < f.size(); ++t) {
    visit(Id(f.v1[t]), Id(f.v2[t]), f.weight0[t]);
    visit(Id(f.v2[t]), Id(f.v0[t]), f.weight1[t]);
    visit(Id(f.v0[t]), Id(f.v1[t]), f.weight2[t]);
  }
  for (const Spoke& s : cells.stars.spokes) visit(s.a, s.b, s.weight);
}

// Calls visit(a, b) for every two vertices of every cell.
template <class Visit>
void ForEachPair(const Cells& cells, Visit visit) {
  const HingeTable& h = cells.hinges;
  for (std::size_t k = 0; k < h.size(); ++k) {
    const std::uint32_t i = IdAt(h.i[k]), j = IdAt(h.j[k]), left = IdAt(h.left[k]),
                        right = IdAt(h.right[k]);
    visit(i, j), visit(i, left), visit(j, left);
    if (right != j) visit(i, right), visit(j, right), visit(left, right);
  }
  const FaceTable& f = cells.faces;
  for (std::size_t t = 0; t < f.size(); ++t) {
    visit(Id(f.v0[t]), Id(f.v1[t])), visit(Id(f.v1[t]), Id(f.v2[t])),
        visit(Id(f.v2[t]), Id(f.v0[t]));
  }
  for (std::size_t s = 0; s < cells.stars.size(); ++s) {
    const auto spokes = SpokesOf(cells.stars, s);
    for (std::size_t k = 0; k < spokes.size(); ++k) {
      visit(spokes[k].a, spokes[k].b);
      if (spokes.size() > kLargeStar) visit(spokes[k].a, spokes[k].b);  // which comes twice there
      for (std::size_t l = 0; l < k; ++l) visit(spokes[k].b, spokes[l].b);
    }
  }
}

}  // namespace

Eigen::SparseMatrix<Complex> AssembleSimilarity(const Cells& cells,
                                                const std::vector<bool>& fixed) {
  LowerSum<Complex> sum(fixed);
  ForEachPair(cells, [&sum](std::uint32_t a, std::uint32_t b) { sum.Count(a, b); });
  sum.EndOfCounting();
  const auto add = [&sum](std::uint32_t row, std::uint32_t column, Complex value) {
    sum.Add(row, column, value);
  };
  const auto add_block = [&](const auto& block) {
    const auto vertices = block.vertices();
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      // |p|², because conj(p)·p need not be exactly real.
      double own = 0;
      for (std::size_t r = 0; r < block.rows(); ++r) {
        own += block.weight(r) * std::norm(block.row(r)[i]);
      }
      sum.Add(vertices[i], vertices[i], own);
      for (std::size_t j = 0; j < i; ++j) {
        Complex product = 0;
        for (std::size_t r = 0; r < block.rows(); ++r) {
          const Complex* row = block.row(r);
          product += block.weight(r) * (std::conj(row[i]) * row[j]);
        }
        if (vertices[i] > vertices[j]) {
          sum.Add(vertices[i], vertices[j], product);
        } else {
          sum.Add(vertices[j], vertices[i], std::conj(product));
        }
      }
    }
  };
  ForEachHinge(cells.hinges, add_block);
  for (std::size_t t = 0; t < cells.faces.size(); ++t) FaceBlock(cells.faces, t).AddTo(sum);
  ForEachStar(cells, add_block, kLargeStar);
  for (std::size_t s = 0; s < cells.stars.size(); ++s) {
    if (SpokesOf(cells.stars, s).size() > kLargeStar) AddLargeStar(cells.stars, s, add);
  }
  return sum.Take();
}

Eigen::SparseMatrix<double> AssembleRigid(const Cells& cells, const std::vector<bool>& fixed) {
  LowerSum<double> sum(fixed);
  ForEachEnergyEdge(cells, [&sum](std::uint32_t a, std::uint32_t b, double) { sum.Count(a, b); });
  sum.EndOfCounting();
  ForEachEnergyEdge(cells, [&sum](std::uint32_t a, std::uint32_t b, double weight) {
    if (weight == 0) return;
    sum.Add(a, a, weight);
    sum.Add(b, b, weight);
    const auto [low, high] = std::minmax(a, b);
    sum.Add(high, low, -weight);
  });
  return sum.Take();
}

SimilarityForce SimilarityForceAt(const Cells& cells, std::span<const Complex> shape) {
  SimilarityForce at{0, std::vector<Complex>(shape.size())};
  ForEachBlock(cells, [&](const auto& block) {
    const auto ids = block.vertices();
    for (std::size_t r = 0; r < block.rows(); ++r) {
      const Complex* row = block.row(r);
      // The rows add up to 0: the place of the block takes no part.
      Complex residual = 0;
      for (std::size_t i = 1; i < ids.size(); ++i) {
        residual += row[i] * (shape[ids[i]] - shape[ids[0]]);
      }
      at.energy += block.weight(r) * std::norm(residual);
      for (std::size_t i = 0; i < ids.size(); ++i) {
        at.force[ids[i]] += block.weight(r) * std::conj(row[i]) * residual;
      }
    }
  });
  return at;
}

}  // namespace arap
