#include "core/deform/roles.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Dense>

#include "core/base/try.h"

namespace arap {
namespace {

// Below this part of itself nothing new is left of a row, and no coefficient counts.
constexpr double kDependent = 1e-8;

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

// The rows that hold one vertex each: whoever is the first on a vertex pins it.
class Pins {
 public:
  // False when the vertex is pinned already.
  bool Add(std::size_t r, std::uint32_t vertex) { return of_.try_emplace(vertex, r).second; }
  // The row that pins the vertex, or nullptr.
  const std::size_t* On(std::uint32_t vertex) const {
    const auto found = of_.find(vertex);
    return found == of_.end() ? nullptr : &found->second;
  }

 private:
  std::map<std::uint32_t, std::size_t> of_;
};

// Gram-Schmidt over rows that share vertices, in order, keeping how each basis vector is made of
// rows. A row counts by what it says of vertices without a pin: the pins' rows are unit vectors, so
// that this is what is left of it when they have been taken out.
class SharedRows {
 public:
  SharedRows(std::span<const Row> rows, const std::vector<std::size_t>& group, const Pins& pins)
      : all_(rows), pins_(pins) {
    for (const std::size_t r : group) {
      for (const std::uint32_t v : rows[r].vertex) {
        if (!pins.On(v)) index_.emplace(v, 0);
      }
    }
    Eigen::Index next = 0;
    for (auto& [vertex, i] : index_) i = next++;
    const auto most = static_cast<Eigen::Index>(group.size());
    basis_.resize(next, std::min(next, most));
    combination_.setZero(basis_.cols(), basis_.cols());
  }

  // Adds the row if it is independent of those before; otherwise says which combination it is.
  bool Add(std::size_t r, DependentRow& dependent) {
    const Row& row = all_[r];
    Eigen::VectorXd x = Eigen::VectorXd::Zero(basis_.rows());
    double norm = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      norm += row.weight[k] * row.weight[k];
      if (!pins_.On(row.vertex[k])) x[index_.at(row.vertex[k])] += row.weight[k];
    }
    const auto taken = static_cast<Eigen::Index>(rows_.size());
    Eigen::VectorXd made = Eigen::VectorXd::Zero(taken);
    // Twice is enough for orthogonality to rounding.
    for (int pass = 0; pass < 2; ++pass) {
      const Eigen::VectorXd dots = basis_.leftCols(taken).transpose() * x;
      x -= basis_.leftCols(taken) * dots;
      made -= combination_.topLeftCorner(taken, taken) * dots;
    }
    const double rest = x.norm();
    if (taken == basis_.cols() || rest <= kDependent * std::sqrt(norm)) {
      Explain(r, made, dependent);
      return false;
    }
    basis_.col(taken) = x / rest;
    combination_.col(taken).head(taken) = made / rest;
    combination_(taken, taken) = 1 / rest;
    rows_.push_back(r);
    return true;
  }

 private:
  // Row r is −Σ made · row rows_[b], and whatever the pins have to add to that.
  void Explain(std::size_t r, const Eigen::VectorXd& made, DependentRow& dependent) const {
    dependent.row = r;
    std::map<std::size_t, double> pinned;
    const auto add_pinned = [&](const Row& row, double factor) {
      for (std::size_t k = 0; k < 3; ++k) {
        if (const std::size_t* pin = pins_.On(row.vertex[k])) {
          pinned[*pin] += factor * row.weight[k];
        }
      }
    };
    add_pinned(all_[r], 1);
    for (std::size_t b = 0; b < rows_.size(); ++b) {
      const double coefficient = -made[static_cast<Eigen::Index>(b)];
      if (std::abs(coefficient) <= kDependent) continue;
      dependent.combination.emplace_back(rows_[b], coefficient);
      add_pinned(all_[rows_[b]], -coefficient);
    }
    for (const auto& [row, coefficient] : pinned) {
      if (std::abs(coefficient) > kDependent) dependent.combination.emplace_back(row, coefficient);
    }
    std::sort(dependent.combination.begin(), dependent.combination.end());
  }

  std::span<const Row> all_;
  const Pins& pins_;
  std::map<std::uint32_t, Eigen::Index> index_;  // vertex without a pin → coordinate
  std::vector<std::size_t> rows_;                // the independent ones
  Eigen::MatrixXd basis_;                        // a column each, orthonormal
  Eigen::MatrixXd combination_;                  // basis[b] = Σ combination(j, b) · row rows_[j]
};

// The rows of `rows_of` in groups that share vertices without a pin, directly or through others.
std::vector<std::vector<std::size_t>> GroupsOf(std::span<const Row> rows,
                                               const std::vector<std::size_t>& rows_of,
                                               const Pins& pins) {
  UnionFind sets(rows_of.size());
  std::map<std::uint32_t, std::uint32_t> first_on;  // vertex → place in rows_of
  for (std::uint32_t i = 0; i < rows_of.size(); ++i) {
    for (const std::uint32_t v : rows[rows_of[i]].vertex) {
      if (pins.On(v)) continue;
      const auto [found, is_new] = first_on.try_emplace(v, i);
      if (!is_new) sets.Join(found->second, i);
    }
  }
  std::map<std::uint32_t, std::vector<std::size_t>> groups;
  for (std::uint32_t i = 0; i < rows_of.size(); ++i) groups[sets.Find(i)].push_back(rows_of[i]);
  std::vector<std::vector<std::size_t>> out;
  for (auto& [root, group] : groups) out.push_back(std::move(group));
  return out;
}

}  // namespace

Result<std::vector<DependentRow>> FindDependentRows(std::span<const Row> rows,
                                                    const CancelToken& cancel) {
  std::vector<DependentRow> dependent;
  Pins pins;
  std::vector<std::size_t> inside;  // hard rows inside a triangle or on an edge
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (rows[r].compliance > 0) continue;
    const std::uint32_t vertex = rows[r].single_vertex();
    if (vertex == kNone) {
      inside.push_back(r);
    } else if (!pins.Add(r, vertex)) {
      dependent.push_back({r, {{*pins.On(vertex), 1.0}}});
    }
  }
  for (const std::vector<std::size_t>& group : GroupsOf(rows, inside, pins)) {
    SharedRows shared(rows, group, pins);
    for (const std::size_t r : group) {
      CHECK_OK(cancel.Check());
      DependentRow found;
      if (!shared.Add(r, found)) dependent.push_back(std::move(found));
    }
  }
  std::sort(dependent.begin(), dependent.end(),
            [](const DependentRow& a, const DependentRow& b) { return a.row < b.row; });
  return dependent;
}

Result<Roles> DecideRoles(std::size_t components, std::span<const Row> rows,
                          const CancelToken& cancel) {
  Roles roles;
  DecideComponents(components, rows, roles);
  TRY(roles.dependent, FindDependentRows(rows, cancel));
  auto next = roles.dependent.begin();
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (next != roles.dependent.end() && next->row == r) {
      ++next;
    } else if (roles.of[rows[r].component] == ComponentRole::kActive) {
      roles.active_rows.push_back(r);
    }
  }
  return roles;
}

}  // namespace arap
