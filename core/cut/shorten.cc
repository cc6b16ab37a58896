#include "core/cut/shorten.h"

#include <algorithm>
#include <functional>
#include <limits>

#include "core/base/try.h"

namespace arap {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// A crossing has to be cheaper by more than rounding, and a sweep by so much that another is worth
// it.
constexpr double kGain = 1e-9;
constexpr double kSweepGain = 0.01;
constexpr int kMaxSweeps = 10;
// Settled vertices and visited sides per vertex of the piece.
constexpr std::size_t kWork = 8;
constexpr std::size_t kCheckEvery = 1u << 14;

}  // namespace

CutShortener::CutShortener(CutField& field, const CancelToken& cancel)
    : field_(field),
      cancel_(cancel),
      is_end_(field.vertex_count(), false),
      tried_(3 * field.triangles().size(), false),
      shore_(3 * field.triangles().size(), kNowhere),
      distance_(field.vertex_count(), kInfinity),
      parent_(field.vertex_count(), kNone) {}

Status CutShortener::Shorten(const Piece& piece, std::span<const std::uint32_t> ends) {
  for (const std::uint32_t v : ends) is_end_[v] = true;
  const std::size_t budget = kWork * (piece.vertices.size() + 64);
  work_ = 0;
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    double total = 0, gained = 0;
    std::vector<std::uint32_t> drawn;
    for (const std::uint32_t t : piece.triangles) {
      for (std::uint32_t side = 3 * t; side < 3 * t + 3; ++side) {
        if (!field_.Drawn(side) || side > field_.gluing().mate[side]) continue;
        drawn.push_back(side);
        total += field_.Cost(side);
      }
    }
    std::vector<std::uint32_t> tried;
    for (const std::uint32_t side : drawn) {
      if (!field_.Drawn(side) || tried_[side]) continue;
      if (work_ > budget) break;
      Stretch stretch = StretchThrough(side);
      TRY(const double gain, Improve(stretch));
      gained += gain;
      for (const std::uint32_t s : stretch) {
        const std::uint32_t lower = std::min(s, field_.gluing().mate[s]);
        tried_[lower] = true;
        tried.push_back(lower);
      }
    }
    for (const std::uint32_t side : tried) tried_[side] = false;
    if (gained <= kSweepGain * total || work_ > budget) break;
  }
  return {};
}

bool CutShortener::Free(std::uint32_t vertex) const {
  return field_.Degree(vertex) == 0 && !field_.OnRim(vertex);
}

bool CutShortener::Node(std::uint32_t vertex) const {
  return field_.Degree(vertex) != 2 || field_.OnRim(vertex) || is_end_[vertex];
}

// The other drawn side at the end of `side`, which is no node.
std::uint32_t CutShortener::Onward(std::uint32_t side) const {
  std::uint32_t onward = kNone;
  field_.ForEachLeaving(field_.End(side), [&](std::uint32_t other) {
    if (field_.Drawn(other) && other != field_.gluing().mate[side]) onward = other;
  });
  return onward;
}

CutShortener::Stretch CutShortener::StretchThrough(std::uint32_t side) const {
  // Back to the node before, then forward from there.
  std::uint32_t back = field_.gluing().mate[side];
  while (!Node(field_.End(back))) back = Onward(back);
  Stretch stretch{field_.gluing().mate[back]};
  while (!Node(field_.End(stretch.back()))) stretch.push_back(Onward(stretch.back()));
  return stretch;
}

// Replaces the stretch by a cheaper one, if there is, and says by how much.
Result<double> CutShortener::Improve(Stretch& stretch) {
  double cost = 0;
  for (const std::uint32_t side : stretch) {
    cost += field_.Cost(side);
    field_.Erase(side);
  }
  const std::uint32_t from = field_.Start(stretch.front()), to = field_.End(stretch.back());
  TRY(auto crossing,
      CheapestCrossing(stretch.front(), field_.gluing().mate[stretch.back()], cost * (1 - kGain)));
  const bool found = !crossing.empty();
  if (found) stretch = std::move(crossing);
  for (const std::uint32_t side : stretch) field_.Draw(side);
  if (!found) return 0.0;
  Prune(from);
  Prune(to);
  return cost - best_;
}

// Sews up what hangs loose from `vertex`.
void CutShortener::Prune(std::uint32_t vertex) {
  while (field_.Degree(vertex) == 1 && !field_.OnRim(vertex) && !is_end_[vertex]) {
    std::uint32_t last = kNone;
    field_.ForEachLeaving(vertex, [&](std::uint32_t side) {
      if (field_.Drawn(side)) last = side;
    });
    vertex = field_.End(last);
    field_.Erase(last);
  }
}

// The open sides of the shore in the sector of `leaving`, a side that is not open; none when its
// start is a free vertex.
std::vector<std::uint32_t> CutShortener::ShoreAt(std::uint32_t leaving) {
  if (Free(field_.Start(leaving))) return {};
  const Gluing& gluing = field_.gluing();
  std::uint32_t arriving = PreviousSide(leaving);
  while (!gluing.open(arriving)) arriving = PreviousSide(gluing.mate[arriving]);
  std::vector<std::uint32_t> shore;
  std::uint32_t side = arriving;
  do {
    shore.push_back(side);
    side = gluing.NextOpen(side);
  } while (side != arriving);
  work_ += shore.size();
  return shore;
}

// The shore that lies behind a side that ends at a vertex that is not free.
CutShortener::Shore CutShortener::ShoreBehind(std::uint32_t side) const {
  return static_cast<Shore>(shore_[field_.gluing().NextOpen(side)]);
}

// Goes along `side`, whose start is `distance` away. `goal` is the free vertex to reach, or kNone
// when the goal is the far shore.
void CutShortener::Try(std::uint32_t side, double distance, std::uint32_t goal) {
  const std::uint32_t vertex = field_.End(side);
  distance += field_.Cost(side);
  if (distance >= best_) return;
  if (vertex == goal || (!Free(vertex) && ShoreBehind(side) == kFar)) {
    best_ = distance, best_side_ = side;
  } else if (Free(vertex) && distance < distance_[vertex]) {
    if (distance_[vertex] == kInfinity) touched_.push_back(vertex);
    distance_[vertex] = distance, parent_[vertex] = side;
    queue_.emplace(distance, vertex);
  }
}

// From the shore (or the free vertex) where `leaving` starts to the one where `arriving` starts,
// for less than `limit`; empty when there is no such way.
Result<CutShortener::Stretch> CutShortener::CheapestCrossing(std::uint32_t leaving,
                                                             std::uint32_t arriving, double limit) {
  const std::vector<std::uint32_t> near = ShoreAt(leaving), far = ShoreAt(arriving);
  for (const std::uint32_t side : near) shore_[side] = kNear;
  for (const std::uint32_t side : far) shore_[side] = kFar;
  const std::uint32_t goal = far.empty() ? field_.Start(arriving) : kNone;
  best_ = limit, best_side_ = kNone;
  if (near.empty()) {
    const std::uint32_t start = field_.Start(leaving);
    distance_[start] = 0;
    touched_.push_back(start);
    queue_.emplace(0, start);
  }
  const Gluing& gluing = field_.gluing();
  for (const std::uint32_t open : near) {
    for (std::uint32_t side = NextSide(open); !gluing.open(side);) {
      Try(side, 0, goal);
      side = NextSide(gluing.mate[side]);
    }
  }
  Status status;
  while (!queue_.empty()) {
    const auto [distance, vertex] = queue_.top();
    queue_.pop();
    if (distance >= best_ || !status) continue;  // empties the queue
    if (distance > distance_[vertex]) continue;
    if (++work_ % kCheckEvery == 0) status = cancel_.Check();
    field_.ForEachLeaving(vertex, [&, d = distance](std::uint32_t side) { Try(side, d, goal); });
  }
  Stretch stretch;
  for (std::uint32_t side = best_side_; side != kNone;) {
    stretch.push_back(side);
    const std::uint32_t vertex = field_.Start(side);
    side = Free(vertex) ? parent_[vertex] : kNone;
  }
  std::reverse(stretch.begin(), stretch.end());
  for (const std::uint32_t v : touched_) distance_[v] = kInfinity, parent_[v] = kNone;
  touched_.clear();
  for (const std::uint32_t side : near) shore_[side] = kNowhere;
  for (const std::uint32_t side : far) shore_[side] = kNowhere;
  CHECK_OK(std::move(status));
  return stretch;
}

}  // namespace arap
