#include "core/deform/roles.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Dense>

namespace arap {
namespace {

void DecideComponents(std::size_t count, std::span<const Row> rows, Roles& roles) {
  std::vector<const Row*> first(count, nullptr);
  roles.of.assign(count, ComponentRole::kResting);
  for (const Row& row : rows) {
    const std::uint32_t c = row.component;
    if (first[c] == nullptr) {
      first[c] = &row;
      roles.of[c] = ComponentRole::kTranslating;
    } else if (std::abs(row.rest - first[c]->rest) > kCoincident) {
      roles.of[c] = ComponentRole::kActive;
    }
  }
  roles.active_slot.assign(count, kNone);
  for (std::size_t c = 0; c < count; ++c) {
    if (roles.of[c] != ComponentRole::kActive) continue;
    roles.active_slot[c] = static_cast<std::uint32_t>(roles.active_components++);
  }
}

// Gram-Schmidt over the hard rows, in order, keeping how each basis vector is made of rows.
class HardRows {
 public:
  explicit HardRows(std::span<const Row> rows) : all_(rows) {
    for (const Row& row : rows) {
      if (row.compliance > 0) continue;
      for (const std::uint32_t v : row.vertex) index_.emplace(v, 0);
    }
    int next = 0;
    for (auto& [vertex, i] : index_) i = next++;
  }

  // Adds the row if it is independent of those before; otherwise says which combination it is.
  bool Add(std::size_t r, DependentRow& dependent) {
    const Row& row = all_[r];
    Eigen::VectorXd x = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(index_.size()));
    for (std::size_t k = 0; k < 3; ++k) x[index_.at(row.vertex[k])] += row.weight[k];
    const double norm = x.norm();
    Eigen::VectorXd made = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(rows_.size()) + 1);
    made[made.size() - 1] = 1;
    // Twice is enough for orthogonality to rounding.
    for (int pass = 0; pass < 2; ++pass) {
      for (std::size_t b = 0; b < basis_.size(); ++b) {
        const double dot = basis_[b].dot(x);
        x -= dot * basis_[b];
        made.head(combination_[b].size()) -= dot * combination_[b];
      }
    }
    const double rest = x.norm();
    if (rest <= kDependent * norm) {
      dependent.row = r;
      for (std::size_t b = 0; b < rows_.size(); ++b) {
        const double coefficient = -made[static_cast<Eigen::Index>(b)];
        if (std::abs(coefficient) > kDependent) {
          dependent.combination.emplace_back(rows_[b], coefficient);
        }
      }
      return false;
    }
    rows_.push_back(r);
    basis_.push_back(x / rest);
    combination_.push_back(made / rest);
    return true;
  }

 private:
  static constexpr double kDependent = 1e-8;
  std::span<const Row> all_;
  std::map<std::uint32_t, int> index_;  // touched vertex → coordinate
  std::vector<std::size_t> rows_;       // the independent ones
  std::vector<Eigen::VectorXd> basis_;
  std::vector<Eigen::VectorXd> combination_;  // basis[b] = Σ combination[b][j] · row rows_[j]
};

}  // namespace

Roles DecideRoles(std::size_t components, std::span<const Row> rows) {
  Roles roles;
  DecideComponents(components, rows, roles);
  HardRows hard(rows);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    DependentRow dependent;
    if (rows[r].compliance == 0 && !hard.Add(r, dependent)) {
      roles.dependent.push_back(std::move(dependent));
    } else if (roles.of[rows[r].component] == ComponentRole::kActive) {
      roles.active_rows.push_back(r);
    }
  }
  return roles;
}

}  // namespace arap
