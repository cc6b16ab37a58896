#include "core/mesh/gluing.h"

#include <utility>

#include <fmt/format.h>

#include "core/base/try.h"

namespace arap {
namespace {

// Walks over the triangles, neighbour by neighbour, and finds what runs against its start.
class Orienter {
 public:
  Orienter(std::span<const Triangle> triangles, const Gluing& gluing)
      : triangles_(triangles),
        gluing_(gluing),
        seen_(triangles.size(), false),
        turned_(triangles.size(), false) {}

  Result<std::vector<bool>> Run() {
    for (std::uint32_t start = 0; start < triangles_.size(); ++start) {
      if (seen_[start]) continue;
      seen_[start] = true;
      queue_.assign(1, start);
      // What lies behind a cut waits until nothing else is left: only joined triangles must agree.
      while (!queue_.empty() || CrossACut()) {
        const std::uint32_t t = queue_.back();
        queue_.pop_back();
        CHECK_OK(Visit(t));
      }
    }
    return std::move(turned_);
  }

 private:
  // Two sides of one edge run alike when their triangles do not agree.
  bool Against(std::uint32_t side, std::uint32_t mate) const {
    const bool alike = SideStart(triangles_, side) == SideStart(triangles_, mate);
    return alike != (turned_[side / 3] != turned_[mate / 3]);
  }

  void Reach(std::uint32_t side, std::uint32_t mate) {
    turned_[mate / 3] = Against(side, mate);
    seen_[mate / 3] = true;
    queue_.push_back(mate / 3);
  }

  Status Visit(std::uint32_t t) {
    for (std::uint32_t side = 3 * t; side < 3 * t + 3; ++side) {
      const std::uint32_t mate = gluing_.mate[side];
      if (mate == kNone) continue;
      if (gluing_.cut[side]) {
        if (!seen_[mate / 3]) behind_cuts_.push_back(side);
      } else if (!seen_[mate / 3]) {
        Reach(side, mate);
      } else if (Against(side, mate)) {
        return Fail(Fault(FaultKind::kNotOrientable,
                          fmt::format("Triangles {} and {} cannot be oriented alike: the surface "
                                      "has one side only.",
                                      t, mate / 3))
                        .Field("mesh.triangles")
                        .Elements({t, mate / 3}));
      }
    }
    return {};
  }

  bool CrossACut() {
    while (!behind_cuts_.empty()) {
      const std::uint32_t side = behind_cuts_.back();
      behind_cuts_.pop_back();
      if (seen_[gluing_.mate[side] / 3]) continue;
      Reach(side, gluing_.mate[side]);
      return true;
    }
    return false;
  }

  std::span<const Triangle> triangles_;
  const Gluing& gluing_;
  std::vector<bool> seen_, turned_;
  std::vector<std::uint32_t> queue_;        // triangles
  std::vector<std::uint32_t> behind_cuts_;  // sides
};

}  // namespace

Gluing GlueAll(std::span<const Side> sides) {
  Gluing gluing{std::vector<std::uint32_t>(sides.size(), kNone),
                std::vector<bool>(sides.size(), false)};
  ForEachEdge(sides, [&](std::span<const Side> edge) {
    if (edge.size() != 2) return;
    gluing.mate[edge[0].index] = edge[1].index;
    gluing.mate[edge[1].index] = edge[0].index;
  });
  return gluing;
}

Result<std::vector<bool>> TrianglesToTurn(std::span<const Triangle> triangles,
                                          const Gluing& gluing) {
  // Most surfaces come with triangles that agree already.
  bool agree = true;
  for (std::uint32_t side = 0; side < gluing.mate.size() && agree; ++side) {
    const std::uint32_t mate = gluing.mate[side];
    if (mate == kNone || mate < side) continue;
    agree = SideStart(triangles, side) != SideStart(triangles, mate);
  }
  if (agree) return std::vector<bool>(triangles.size(), false);
  return Orienter(triangles, gluing).Run();
}

std::vector<std::uint32_t> CutOneSided(std::span<const Triangle> triangles, Gluing& gluing) {
  std::vector<bool> seen(triangles.size(), false), turned(triangles.size(), false);
  std::vector<std::uint32_t> cut;
  std::vector<std::uint32_t> queue;  // triangles, ring after ring, so that the fronts meet half-way
  for (std::uint32_t start = 0; start < triangles.size(); ++start) {
    if (seen[start]) continue;
    seen[start] = true;
    queue.assign(1, start);
    for (std::size_t next = 0; next < queue.size(); ++next) {
      const std::uint32_t t = queue[next];
      for (std::uint32_t side = 3 * t; side < 3 * t + 3; ++side) {
        if (gluing.open(side)) continue;
        const std::uint32_t mate = gluing.mate[side];
        const bool alike = SideStart(triangles, side) == SideStart(triangles, mate);
        const bool wanted = alike != turned[t];
        if (!seen[mate / 3]) {
          seen[mate / 3] = true;
          turned[mate / 3] = wanted;
          queue.push_back(mate / 3);
        } else if (turned[mate / 3] != wanted) {
          gluing.Cut(side);
          cut.push_back(side);
        }
      }
    }
  }
  return cut;
}

void TurnTriangles(const std::vector<bool>& turned, std::vector<Triangle>& triangles,
                   Gluing& gluing) {
  const auto renumbered = [&turned](std::uint32_t side) {
    return side != kNone && side % 3 != 0 && turned[side / 3] ? side / 3 * 3 + 3 - side % 3 : side;
  };
  for (std::uint32_t& mate : gluing.mate) mate = renumbered(mate);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    if (!turned[t]) continue;
    std::swap(triangles[t][1], triangles[t][2]);
    std::swap(gluing.mate[3 * t + 1], gluing.mate[3 * t + 2]);
    const bool first = gluing.cut[3 * t + 1];
    gluing.cut[3 * t + 1] = gluing.cut[3 * t + 2];
    gluing.cut[3 * t + 2] = first;
  }
}

}  // namespace arap
