#include "core/deform/roles.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Dense>

namespace arap {
namespace {

void DecideComponents(CompiledHandlesParts& parts) {
  const std::size_t count = parts.mesh->parts().components.size();
  std::vector<const Row*> first(count, nullptr);
  parts.roles.assign(count, ComponentRole::kResting);
  for (const Row& row : parts.rows) {
    const std::uint32_t c = row.component;
    if (first[c] == nullptr) {
      first[c] = &row;
      parts.roles[c] = ComponentRole::kTranslating;
    } else if (std::abs(row.rest - first[c]->rest) > kCoincident) {
      parts.roles[c] = ComponentRole::kActive;
    }
  }
  parts.active_slot.assign(count, kNone);
  parts.active_components = 0;
  for (std::size_t c = 0; c < count; ++c) {
    if (parts.roles[c] != ComponentRole::kActive) continue;
    parts.active_slot[c] = static_cast<std::uint32_t>(parts.active_components++);
  }
}

// Gram-Schmidt over the hard rows, in order, keeping how each basis vector is made of rows.
class HardRows {
 public:
  explicit HardRows(const CompiledHandlesParts& parts) {
    for (const Row& row : parts.rows) {
      if (row.compliance > 0) continue;
      for (const std::uint32_t v : row.vertex) index_.emplace(v, 0);
    }
    int next = 0;
    for (auto& [vertex, i] : index_) i = next++;
  }

  // Adds the row if it is independent of those before; otherwise says which combination it is.
  bool Add(const CompiledHandlesParts& parts, std::size_t r, DependentRow& dependent) {
    const Row& row = parts.rows[r];
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
        if (std::abs(coefficient) > kDependent)
          dependent.combination.emplace_back(rows_[b], coefficient);
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
  std::map<std::uint32_t, int> index_;  // touched vertex → coordinate
  std::vector<std::size_t> rows_;
  std::vector<Eigen::VectorXd> basis_;
  std::vector<Eigen::VectorXd> combination_;  // basis[b] = Σ combination[b][j] · row rows_[j]
};

}  // namespace

void DecideRoles(CompiledHandlesParts& parts) {
  DecideComponents(parts);
  parts.active_rows.clear();
  parts.dependent.clear();
  HardRows hard(parts);
  for (std::size_t r = 0; r < parts.rows.size(); ++r) {
    const Row& row = parts.rows[r];
    DependentRow dependent;
    if (row.compliance == 0 && !hard.Add(parts, r, dependent)) {
      parts.dependent.push_back(std::move(dependent));
    } else if (parts.roles[row.component] == ComponentRole::kActive) {
      parts.active_rows.push_back(r);
    }
  }
}

}  // namespace arap
