#include "core/drawing/reel.h"

#include <algorithm>
#include <utility>

namespace arap {

Reel::Reel(std::vector<Triangle> triangles, std::optional<std::size_t> total)
    : triangles_(std::move(triangles)) {
  if (!total) return;
  step_ = std::max<std::size_t>((*total + kMostAnimated - 1) / kMostAnimated, 1);
  sheet_ = Spread(*total, kMostOnSheet);
}

bool Reel::IsWanted(const Frame& frame) const {
  return frame.index % step_ == 0 || std::binary_search(sheet_.begin(), sheet_.end(), frame.index);
}

void Reel::Add(std::size_t number, std::vector<Complex> shape, std::vector<Complex> handles) {
  bounds_.Add(shape);
  bounds_.Add(handles);
  if (!frames_.empty() && !IsWanted(frames_.back())) frames_.pop_back();
  frames_.push_back({count_++, number, std::move(shape), std::move(handles)});
  if (frames_.size() <= 2 * kMostAnimated + sheet_.size()) return;
  step_ *= 2;
  std::erase_if(frames_, [this](const Frame& frame) {
    return frame.index + 1 != count_ && !IsWanted(frame);
  });
}

Film Reel::Show(const std::vector<const Frame*>& frames, const std::string& caption) const {
  Film film;
  film.triangles = triangles_;
  film.caption = caption;
  for (const Frame* const frame : frames) {
    film.shapes.push_back(frame->shape);
    film.handles.push_back(frame->handles);
    film.numbers.push_back(frame->number);
  }
  return film;
}

std::string Reel::Animation(const std::string& caption) const {
  constexpr double kFramesPerSecond = 30;
  std::size_t step = step_;
  while ((count_ + step - 1) / step > kMostAnimated) step *= 2;
  std::vector<const Frame*> shown;
  for (const Frame& frame : frames_) {
    if (frame.index % step == 0) shown.push_back(&frame);
  }
  const double seconds = std::max(1.0, static_cast<double>(count_) / kFramesPerSecond);
  return FormatAnimation(Show(shown, caption), seconds, bounds_);
}

std::string Reel::Sheet(const std::string& caption) const {
  std::vector<const Frame*> shown;
  for (const std::size_t index : Spread(count_, kMostOnSheet)) {
    const auto after = std::lower_bound(
        frames_.begin(), frames_.end(), index,
        [](const Frame& frame, std::size_t wanted) { return frame.index < wanted; });
    // There is one: the last frame is always kept, and so is the first.
    const bool earlier = after->index != index && index - (after - 1)->index < after->index - index;
    const Frame* const nearest = &*(earlier ? after - 1 : after);
    if (shown.empty() || shown.back() != nearest) shown.push_back(nearest);
  }
  return FormatSheet(Show(shown, caption));
}

std::vector<std::size_t> Spread(std::size_t total, std::size_t count) {
  std::vector<std::size_t> chosen;
  if (total == 0 || count == 0) return chosen;
  if (count == 1) return {0};
  count = std::min(total, count);
  for (std::size_t i = 0; i < count; ++i) {
    chosen.push_back(count == 1 ? 0 : i * (total - 1) / (count - 1));
  }
  return chosen;
}

}  // namespace arap
