#include "core/sparse/dissection.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace arap {
namespace {

std::size_t Index(int i) { return static_cast<std::size_t>(i); }
int Int(std::size_t n) { return static_cast<int>(n); }

// The edges between a left and a right side, and the smallest set of vertices that has an end of every edge. It is read
// off a largest matching, which has as many edges as the set has vertices (König). Vertices of a side count from 0.
class EdgeCover {
 public:
  void Clear() {
    begin_.assign(1, 0);
    ends_.clear();
    rights_ = 0;
  }
  void AddEdge(int right) {
    ends_.push_back(right);
    rights_ = std::max(rights_, Index(right) + 1);
  }
  void EndLeft() { begin_.push_back(ends_.size()); }
  std::size_t lefts() const { return begin_.size() - 1; }

  // Finds the set: afterwards left(l) and right(r) say whether a vertex belongs to it.
  void Find() {
    left_of_.assign(rights_, -1);
    seen_.assign(rights_, -1);
    std::vector<int> alone;
    for (std::size_t l = 0; l < lefts(); ++l) {
      if (!Pair(Int(l), Int(l))) alone.push_back(Int(l));
    }
    // From left vertices without a partner, walk along any edge to the right and back along the matching. What this
    // reaches on the right belongs to the set, and what it does not reach on the left.
    left_.assign(lefts(), true);
    right_.assign(rights_, false);
    for (const int l : alone) left_[Index(l)] = false;
    while (!alone.empty()) {
      const std::size_t l = Index(alone.back());
      alone.pop_back();
      for (std::size_t e = begin_[l]; e < begin_[l + 1]; ++e) {
        const std::size_t r = Index(ends_[e]);
        if (right_[r]) continue;
        right_[r] = true;
        const int next = left_of_[r];
        if (left_[Index(next)]) alone.push_back(next);
        left_[Index(next)] = false;
      }
    }
  }
  bool left(std::size_t l) const { return left_[l]; }
  bool right(std::size_t r) const { return right_[r]; }

 private:
  // Matches l, if need be by matching other left vertices anew. Returns whether that was possible.
  bool Pair(int l, int round) {
    // Left vertices, each of which would take the partner of the next one; with the edge that it tries next.
    path_.assign(1, {l, begin_[Index(l)]});
    while (!path_.empty()) {
      auto& [left, edge] = path_.back();
      if (edge == begin_[Index(left) + 1]) {
        path_.pop_back();
        continue;
      }
      const std::size_t r = Index(ends_[edge++]);
      if (std::exchange(seen_[r], round) == round) continue;
      if (const int other = left_of_[r]; other >= 0) {
        path_.emplace_back(other, begin_[Index(other)]);
        continue;
      }
      for (const auto& [each, next] : path_) left_of_[Index(ends_[next - 1])] = each;
      return true;
    }
    return false;
  }

  std::vector<std::size_t> begin_{0};
  std::vector<int> ends_;
  std::size_t rights_ = 0;
  std::vector<int> left_of_, seen_;
  std::vector<std::pair<int, std::size_t>> path_;
  std::vector<bool> left_, right_;
};

class Dissection {
 public:
  Dissection(const LowerPattern& lower, std::span<const std::complex<double>> points)
      : points_(points), vertices_(points.size()), part_(points.size(), 0) {
    TakePattern(lower);
    for (std::size_t v = 0; v < vertices_.size(); ++v) vertices_[v] = Int(v);
  }

  std::vector<int> Run() {
    std::vector<int> depth(points_.size(), -1);
    int deepest = 0;
    std::vector<Part> parts{{0, vertices_.size(), 0}};
    while (!parts.empty()) {
      const Part part = parts.back();
      parts.pop_back();
      if (part.end - part.begin <= kLeaf || !Cut(part)) continue;
      for (const int v : cut_) depth[Index(v)] = part.depth;
      deepest = std::max(deepest, part.depth);
      const std::size_t middle = Separate(part);
      parts.push_back({part.begin, middle, part.depth + 1});
      parts.push_back({middle, part.end - cut_.size(), part.depth + 1});
    }
    for (int& stage : depth) stage = stage < 0 ? 0 : deepest - stage + 1;
    return depth;
  }

 private:
  // Parts of fewer vertices are left to minimum degree.
  static constexpr std::size_t kLeaf = 2000;
  // A cut does not pay when it has more vertices than this times the square root of the part's.
  static constexpr double kLongest = 8;

  struct Part {
    std::size_t begin, end;  // in vertices_
    int depth;
  };

  void TakePattern(const LowerPattern& lower) {
    const std::size_t n = points_.size();
    begin_.assign(n + 1, 0);
    const auto for_each_edge = [&](auto visit) {
      for (std::size_t c = 0; c < n; ++c) {
        for (int at = lower.begin[c]; at < lower.begin[c + 1]; ++at) {
          if (const std::size_t r = Index(lower.rows[Index(at)]); r != c) visit(r, c);
        }
      }
    };
    for_each_edge([&](std::size_t r, std::size_t c) { ++begin_[r + 1], ++begin_[c + 1]; });
    for (std::size_t v = 0; v < n; ++v) begin_[v + 1] += begin_[v];
    neighbours_.resize(begin_[n]);
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for_each_edge([&](std::size_t r, std::size_t c) {
      neighbours_[next[r]++] = Int(c);
      neighbours_[next[c]++] = Int(r);
    });
  }

  // Puts the vertices of the part in two halves, and finds the fewest that keep them apart. False where that does not pay.
  bool Cut(const Part& part) {
    Halve(part);
    const std::size_t middle = (part.begin + part.end) / 2;
    const int here = part_[Index(vertices_[part.begin])], beyond = parts_;
    for (std::size_t k = middle; k < part.end; ++k) part_[Index(vertices_[k])] = beyond;
    // Left ones that have an edge to the right, and the right ends of those.
    std::vector<int> left, right;
    place_.resize(points_.size(), -1);
    cover_.Clear();
    for (std::size_t k = part.begin; k < middle; ++k) {
      const int v = vertices_[k];
      bool crosses = false;
      for (std::size_t e = begin_[Index(v)]; e < begin_[Index(v) + 1]; ++e) {
        const int u = neighbours_[e];
        if (part_[Index(u)] != beyond) continue;
        int& place = place_[Index(u)];
        if (place < 0) place = Int(right.size()), right.push_back(u);
        cover_.AddEdge(place);
        crosses = true;
      }
      if (crosses) left.push_back(v), cover_.EndLeft();
    }
    for (const int u : right) place_[Index(u)] = -1;
    const auto most = kLongest * std::sqrt(static_cast<double>(part.end - part.begin));
    if (static_cast<double>(std::max(left.size(), right.size())) > most) {
      for (std::size_t k = middle; k < part.end; ++k) part_[Index(vertices_[k])] = here;
      return false;
    }
    ++parts_;
    cover_.Find();
    cut_.clear();
    for (std::size_t l = 0; l < left.size(); ++l) {
      if (cover_.left(l)) cut_.push_back(left[l]);
    }
    for (std::size_t r = 0; r < right.size(); ++r) {
      if (cover_.right(r)) cut_.push_back(right[r]);
    }
    for (const int v : cut_) part_[Index(v)] = kCut;
    return true;
  }

  // Reorders the part's vertices: first those on the lower half along its longer side.
  void Halve(const Part& part) {
    constexpr double kInf = std::numeric_limits<double>::infinity();
    double low[2]{kInf, kInf}, high[2]{-kInf, -kInf};
    for (std::size_t k = part.begin; k < part.end; ++k) {
      const std::complex<double> p = points_[Index(vertices_[k])];
      low[0] = std::min(low[0], p.real()), high[0] = std::max(high[0], p.real());
      low[1] = std::min(low[1], p.imag()), high[1] = std::max(high[1], p.imag());
    }
    const bool across = high[0] - low[0] >= high[1] - low[1];
    along_.clear();
    for (std::size_t k = part.begin; k < part.end; ++k) {
      const std::complex<double> p = points_[Index(vertices_[k])];
      along_.emplace_back(across ? p.real() : p.imag(), vertices_[k]);
    }
    const auto middle = static_cast<std::ptrdiff_t>((part.begin + part.end) / 2 - part.begin);
    std::nth_element(along_.begin(), along_.begin() + middle, along_.end());
    for (std::size_t k = 0; k < along_.size(); ++k) vertices_[part.begin + k] = along_[k].second;
  }

  // Moves the part's vertices together without those of the cut. Returns where its second half begins.
  std::size_t Separate(const Part& part) {
    const std::size_t half = (part.begin + part.end) / 2;
    std::size_t to = part.begin, middle = 0;
    for (std::size_t k = part.begin; k < part.end; ++k) {
      if (k == half) middle = to;
      if (part_[Index(vertices_[k])] != kCut) vertices_[to++] = vertices_[k];
    }
    return middle;
  }

  static constexpr int kCut = -1;

  std::span<const std::complex<double>> points_;
  std::vector<std::size_t> begin_;
  std::vector<int> neighbours_;  // of vertex v from begin_[v] on
  std::vector<int> vertices_;    // part by part
  std::vector<int> part_;        // #n, the part that a vertex is in, or kCut
  int parts_ = 1;
  std::vector<std::pair<double, int>> along_;
  std::vector<int> place_;  // of right ends, while a part is cut
  EdgeCover cover_;
  std::vector<int> cut_;
};

}  // namespace

std::vector<int> DissectionStages(const LowerPattern& lower,
                                  std::span<const std::complex<double>> points) {
  return Dissection(lower, points).Run();
}

}  // namespace arap
