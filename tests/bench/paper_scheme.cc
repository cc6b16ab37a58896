#include "tests/bench/paper_scheme.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/mesh/topology.h"

namespace arap::bench {
namespace {

using Index = Eigen::Index;
using Triplets = std::vector<Eigen::Triplet<double, int>>;

Eigen::SparseMatrix<double> FromTriplets(std::size_t size, const Triplets& triplets) {
  Eigen::SparseMatrix<double> matrix(static_cast<Index>(size), static_cast<Index>(size));
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  return matrix;
}

// The lower triangle of the outer product of one row with itself.
template <std::size_t N>
void AddSquare(const std::array<int, N>& columns, const std::array<double, N>& row, Triplets& out) {
  for (std::size_t p = 0; p < N; ++p) {
    for (std::size_t q = 0; q < N; ++q) {
      if (columns[p] >= columns[q]) out.emplace_back(columns[p], columns[q], row[p] * row[q]);
    }
  }
}

}  // namespace

PaperScheme::PaperScheme(const PlanarMesh& mesh)
    : vertices_(mesh.vertices.size()),
      first_right_(2 * vertices_),
      second_right_(2 * vertices_),
      shape_(mesh.vertices) {
  const Topology topology = BuildTopology(vertices_, mesh.triangles);
  fits_.reserve(topology.edges.size());
  for (const Edge& edge : topology.edges) {
    const std::array<std::uint32_t, 4> around{edge.v0, edge.v1, edge.opposite[0], edge.opposite[1]};
    AddFit(mesh, std::span(around).first(edge.boundary() ? 3 : 4));
  }
  first_ = std::make_unique<PenaltySystem>(FirstMatrix(), true);
  second_ = std::make_unique<PenaltySystem>(SecondMatrix(), false);
}

void PaperScheme::AddFit(const PlanarMesh& mesh, std::span<const std::uint32_t> vertices) {
  EdgeFit fit;
  const Complex origin = mesh.vertices[vertices[0]];
  double size = 0;
  for (const std::uint32_t v : vertices) size += std::norm(mesh.vertices[v] - origin);
  for (std::size_t q = 0; q < 4; ++q) {
    fit.vertices[q] = q < vertices.size() ? vertices[q] : vertices[0];
    const Complex arm = (mesh.vertices[fit.vertices[q]] - origin) / size;
    fit.a[q] = arm.real();
    fit.b[q] = arm.imag();
    // Differences from vertex 0: it takes what the others give.
    fit.a[0] -= arm.real();
    fit.b[0] -= arm.imag();
  }
  const Complex edge = mesh.vertices[vertices[1]] - origin;
  fit.x = edge.real();
  fit.y = edge.imag();
  fits_.push_back(fit);
}

// L1ᵗL1: two rows per edge, (v_j − v_i) − T e with T = [c s; −s c].
Eigen::SparseMatrix<double> PaperScheme::FirstMatrix() const {
  Triplets triplets;
  triplets.reserve(fits_.size() * 72);
  for (const EdgeFit& fit : fits_) {
    std::array<int, 8> columns{};
    std::array<double, 8> row_x{}, row_y{};
    for (std::size_t q = 0; q < 4; ++q) {
      columns[2 * q] = 2 * static_cast<int>(fit.vertices[q]);
      columns[2 * q + 1] = columns[2 * q] + 1;
      const double along = fit.a[q] * fit.x + fit.b[q] * fit.y;
      const double across = fit.b[q] * fit.x - fit.a[q] * fit.y;
      const double difference = q == 0 ? -1 : q == 1 ? 1 : 0;
      row_x[2 * q] = row_y[2 * q + 1] = difference - along;
      row_x[2 * q + 1] = -across;
      row_y[2 * q] = across;
    }
    AddSquare(columns, row_x, triplets);
    AddSquare(columns, row_y, triplets);
  }
  return FromTriplets(2 * vertices_, triplets);
}

// L2ᵗL2, the same for x and y.
Eigen::SparseMatrix<double> PaperScheme::SecondMatrix() const {
  Triplets triplets;
  triplets.reserve(fits_.size() * 3);
  for (const EdgeFit& fit : fits_) {
    const std::array<int, 2> columns{static_cast<int>(fit.vertices[0]),
                                     static_cast<int>(fit.vertices[1])};
    AddSquare<2>(columns, {-1, 1}, triplets);
  }
  return FromTriplets(vertices_, triplets);
}

void PaperScheme::Compile(std::span<const PaperHandle> handles) {
  handles_.assign(handles.begin(), handles.end());
  first_->Clear();
  second_->Clear();
  for (const PaperHandle& handle : handles_) {
    for (std::size_t p = 0; p < 3; ++p) {
      for (std::size_t q = 0; q < 3; ++q) {
        const auto row = static_cast<Index>(handle.vertices[p]);
        const auto column = static_cast<Index>(handle.vertices[q]);
        const double value = kWeight * handle.weights[p] * handle.weights[q];
        first_->Add(2 * row, 2 * column, value);
        first_->Add(2 * row + 1, 2 * column + 1, value);
        second_->Add(row, column, value);
      }
    }
  }
  first_->Factor();
  second_->Factor();
}

std::span<const Complex> PaperScheme::Update(std::span<const Complex> targets) {
  std::ranges::fill(first_right_, 0.0);
  std::ranges::fill(second_right_, 0.0);
  for (std::size_t h = 0; h < handles_.size(); ++h) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t v = handles_[h].vertices[k];
      const Complex pull = kWeight * handles_[h].weights[k] * targets[h];
      first_right_[2 * v] += pull.real();
      first_right_[2 * v + 1] += pull.imag();
      second_right_[v] += pull.real();
      second_right_[vertices_ + v] += pull.imag();
    }
  }
  TurnEdges(first_->Solve(first_right_, 1));
  const double* xy = second_->Solve(second_right_, 2);
  for (std::size_t v = 0; v < vertices_; ++v) shape_[v] = {xy[v], xy[vertices_ + v]};
  return shape_;
}

// Adds the edges, turned as the first step's shape says, to the second right-hand side.
void PaperScheme::TurnEdges(const double* shape) {
  double* const x = second_right_.data();
  double* const y = x + vertices_;
  for (const EdgeFit& fit : fits_) {
    double c = 0, s = 0;
    for (std::size_t q = 0; q < 4; ++q) {
      const double* const p = shape + 2 * std::size_t{fit.vertices[q]};
      c += fit.a[q] * p[0] + fit.b[q] * p[1];
      s += fit.b[q] * p[0] - fit.a[q] * p[1];
    }
    const double size = std::sqrt(c * c + s * s);
    if (size > 0) c /= size, s /= size;
    const double turned_x = c * fit.x + s * fit.y;
    const double turned_y = c * fit.y - s * fit.x;
    x[fit.vertices[1]] += turned_x;
    y[fit.vertices[1]] += turned_y;
    x[fit.vertices[0]] -= turned_x;
    y[fit.vertices[0]] -= turned_y;
  }
}

std::size_t PaperScheme::bytes() const {
  return first_->bytes() + second_->bytes() + fits_.size() * sizeof(EdgeFit) +
         vertices_ * (4 * sizeof(double) + sizeof(Complex));
}

}  // namespace arap::bench
