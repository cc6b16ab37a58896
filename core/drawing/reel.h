// The frames of a film that are shown, picked while the film comes.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "arap/model/mesh.h"
#include "core/base/plane.h"
#include "core/drawing/film.h"

namespace arap {

// Takes the frames of a film one after the other and keeps those that pictures of it show: at most
// kMostKept of them, however many there are.
class Reel {
 public:
  static constexpr std::size_t kMostAnimated = 90;
  static constexpr std::size_t kMostOnSheet = 8;
  static constexpr std::size_t kMostKept = 2 * kMostAnimated + kMostOnSheet + 2;

  // `total`: how many frames will come, if that is known. Then it is known from the start which ones
  // are shown: an animation has every frame, every second, every third… of them, so that the time
  // between two of them is the same throughout, and a sheet has frames evenly chosen, first and last
  // among them. Otherwise an animation of more than kMostAnimated has every second, fourth, eighth…,
  // and a sheet the nearest of those.
  explicit Reel(std::vector<Triangle> triangles, std::optional<std::size_t> total = std::nullopt);

  // The next frame: its number in the track, its vertices, and its handles as in Film.
  void Add(std::size_t number, std::vector<Complex> shape, std::vector<Complex> handles);

  std::size_t frame_count() const { return count_; }
  std::size_t kept_count() const { return frames_.size(); }

  // An animation that loops, one second for 30 frames of the film. Needs at least one frame.
  std::string Animation(const std::string& caption) const;
  // A still sheet of a few frames. Needs at least one frame.
  std::string Sheet(const std::string& caption) const;

 private:
  struct Frame {
    std::size_t index = 0;  // among all that came
    std::size_t number = 0;
    std::vector<Complex> shape, handles;
  };

  // Whether it is shown, as far as that is known.
  bool IsWanted(const Frame& frame) const;
  Film Show(const std::vector<const Frame*>& frames, const std::string& caption) const;

  const std::vector<Triangle> triangles_;
  std::size_t step_ = 1;            // from one frame of an animation to the next, at most
  std::vector<std::size_t> sheet_;  // indices, when the total is known
  std::size_t count_ = 0;
  Bounds bounds_;              // of all that came
  std::vector<Frame> frames_;  // wanted ones, and always the last that came
};

// `count` of `total` indices, evenly spread, first and last among them; all when there are fewer.
std::vector<std::size_t> Spread(std::size_t total, std::size_t count);

}  // namespace arap
