#include "core/cut/cut_graph.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>

#include "core/base/try.h"

namespace arap {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kCheckEvery = 1u << 14;

// A closed piece is cut along a tree of at most so many ends, enough for every corner of a box. A
// further end must count at least this part of what the second one counted.
constexpr std::size_t kMaxEnds = 8;
constexpr double kWorthAnEnd = 0.2;
// High curvature makes a place count up to this many times its distance more.
constexpr double kHigh = 3;

}  // namespace

CutGraph::CutGraph(CutField& field, const CancelToken& cancel)
    : field_(field),
      cancel_(cancel),
      leader_(field.vertex_count()),
      distance_(field.vertex_count(), kInfinity),
      parent_(field.vertex_count(), kNone),
      cotree_(field.triangles().size()) {
  std::iota(leader_.begin(), leader_.end(), 0u);
}

Result<std::vector<std::uint32_t>> CutGraph::Draw(const Piece& piece) {
  ContractBoundaries(piece);
  std::uint32_t root = piece.vertices.front();
  if (piece.closed()) {
    for (const std::uint32_t v : piece.vertices) {
      const double more = field_.Curvature(v) - field_.Curvature(root);
      if (more > 0 || (more == 0 && v < root)) root = v;
    }
  } else {
    root = field_.Start(piece.boundary_starts.front());
  }
  Reach(root, 0, kNone);
  CHECK_OK(Grow());
  if (piece.closed() && piece.genus == 0) return DrawTree(piece);
  for (const std::uint32_t side : piece.boundary_starts) DrawPathToRoot(field_.Start(side));
  if (piece.genus > 0) DrawHandles(piece);
  return std::vector<std::uint32_t>{};
}

void CutGraph::ContractBoundaries(const Piece& piece) {
  for (const std::uint32_t start : piece.boundary_starts) {
    std::uint32_t side = start;
    do {
      leader_[field_.Start(side)] = field_.Start(start);
      side = field_.gluing().NextOpen(side);
    } while (side != start);
  }
}

// Notes that `vertex` can be reached through `side`, at this distance from the root.
void CutGraph::Reach(std::uint32_t vertex, double distance, std::uint32_t side) {
  const std::uint32_t leader = leader_[vertex];
  if (distance >= distance_[leader]) return;
  distance_[leader] = distance;
  parent_[leader] = side;
  queue_.emplace(distance, leader);
}

// Settles everything that was reached, and what can be reached from there.
Status CutGraph::Grow() {
  const auto leave = [this](std::uint32_t vertex, double distance) {
    field_.ForEachLeaving(vertex, [&](std::uint32_t side) {
      Reach(field_.End(side), distance + field_.Cost(side), side);
    });
  };
  for (std::size_t step = 1; !queue_.empty(); ++step) {
    if (step % kCheckEvery == 0) {
      CHECK_OK(cancel_.Check());
    }
    const auto [distance, vertex] = queue_.top();
    queue_.pop();
    if (distance > distance_[vertex]) continue;
    if (!field_.OnRim(vertex)) {
      leave(vertex, distance);
      continue;
    }
    // A whole boundary loop. Nothing of this piece has been drawn yet: what is open is the rim.
    const std::uint32_t start = field_.Leaving(vertex);
    std::uint32_t side = start;
    do {
      leave(field_.Start(side), distance);
      side = field_.gluing().NextOpen(side);
    } while (side != start);
  }
  return {};
}

bool CutGraph::InTree(std::uint32_t side) const {
  return parent_[leader_[field_.End(side)]] == side;
}

void CutGraph::DrawPathToRoot(std::uint32_t vertex) {
  while (true) {
    const std::uint32_t side = parent_[leader_[vertex]];
    if (side == kNone || field_.Drawn(side)) return;
    field_.Draw(side);
    vertex = field_.Start(side);
  }
}

// The cotree crosses the edges outside the tree, those with the dearest loops to the root first. An
// edge that neither holds closes a loop round a handle or through it: two for every handle.
void CutGraph::DrawHandles(const Piece& piece) {
  struct Crossing {
    double loop;
    std::uint32_t side;
  };
  std::vector<Crossing> crossings;
  for (const std::uint32_t t : piece.triangles) {
    for (std::uint32_t side = 3 * t; side < 3 * t + 3; ++side) {
      if (field_.Rim(side)) continue;
      const std::uint32_t mate = field_.gluing().mate[side];
      if (mate < side || InTree(side) || InTree(mate)) continue;
      const double loop = distance_[leader_[field_.Start(side)]] +
                          distance_[leader_[field_.End(side)]] + field_.Cost(side);
      crossings.push_back({loop, side});
    }
  }
  std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) {
    return a.loop != b.loop ? a.loop > b.loop : a.side < b.side;
  });
  for (const Crossing& crossing : crossings) {
    const std::uint32_t a = cotree_.Find(crossing.side / 3);
    const std::uint32_t b = cotree_.Find(field_.gluing().mate[crossing.side] / 3);
    if (a != b) {
      cotree_.Join(a, b);
      continue;
    }
    field_.Draw(crossing.side);
    DrawPathToRoot(field_.Start(crossing.side));
    DrawPathToRoot(field_.End(crossing.side));
  }
}

// A cut of one edge opens nothing: the cheapest edge from `vertex` that does not lead back.
std::uint32_t CutGraph::DrawSecondEdge(std::uint32_t vertex, std::uint32_t back) {
  std::uint32_t best = kNone;
  field_.ForEachLeaving(vertex, [&](std::uint32_t side) {
    if (field_.End(side) == back) return;
    if (best == kNone || field_.Cost(side) < field_.Cost(best)) best = side;
  });
  field_.Draw(best);
  return field_.End(best);
}

// From the root to the place that is farthest and most curved, then from there to the next, as long
// as it is worth it.
Result<std::vector<std::uint32_t>> CutGraph::DrawTree(const Piece& piece) {
  std::vector<std::uint32_t> ends;
  for (const std::uint32_t v : piece.vertices) {
    if (parent_[v] == kNone) ends.push_back(v);  // the root
  }
  double least = 0;
  while (ends.size() < kMaxEnds) {
    double most = -1;
    std::uint32_t end = kNone;
    for (const std::uint32_t v : piece.vertices) {
      if (parent_[v] == kNone) continue;
      const double counts = distance_[v] * (1 + std::min(field_.Curvature(v), kHigh));
      if (counts > most || (counts == most && v < end)) most = counts, end = v;
    }
    if (end == kNone || most < least) break;
    if (ends.size() == 1) least = kWorthAnEnd * most;
    ends.push_back(end);
    std::vector<std::uint32_t> path{end};
    while (parent_[path.back()] != kNone) path.push_back(field_.Start(parent_[path.back()]));
    DrawPathToRoot(end);
    if (ends.size() == 2 && path.size() == 2) {
      path.push_back(DrawSecondEdge(end, path.back()));
      ends.push_back(path.back());
    }
    // What is drawn is the root from now on.
    for (const std::uint32_t v : path) {
      Reach(v, 0, kNone);
      parent_[v] = kNone;
    }
    CHECK_OK(Grow());
  }
  return ends;
}

}  // namespace arap
