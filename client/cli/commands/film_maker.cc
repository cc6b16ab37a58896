#include <limits>

#include "client/cli/adapt.h"
#include "client/cli/commands/stage.h"
#include "core/files/text_file.h"

namespace arap::cli {

FilmMaker::FilmMaker(const StageOptions& options, const Stage& stage)
    : svg_(options.svg),
      frames_svg_(options.frames_svg),
      track_(stage.track()),
      segments_(SegmentsOf(track_)) {
  film_.triangles = stage.mesh().triangles;
}

void FilmMaker::Add(std::size_t frame, const client::Shape& shape) {
  if (svg_.empty() && frames_svg_.empty()) return;
  film_.shapes.push_back(ToPoints(shape.positions));
  film_.handles.push_back(HandlesAt(frame));
  film_.numbers.push_back(frame);
}

std::vector<Complex> FilmMaker::HandlesAt(std::size_t frame) const {
  std::size_t count = track_.handles.size();
  for (const TrackEdit& edit : track_.edits) count += edit.add.size();
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::vector<Complex> handles(count, {kNone, kNone});
  const std::vector<std::size_t>& numbers = SegmentAt(segments_, frame).numbers;
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    handles[numbers[k]] = track_.frames[frame].targets[k].position;
  }
  return handles;
}

Status FilmMaker::Write(const std::string& caption) {
  constexpr std::size_t kSheetFrames = 8;
  if (film_.frame_count() == 0) return {};
  film_.caption = caption;
  if (!svg_.empty()) {
    if (Status written = WriteTextFile(svg_, FormatAnimation(film_)); !written) return written;
  }
  if (!frames_svg_.empty()) return WriteTextFile(frames_svg_, FormatSheet(film_, kSheetFrames));
  return {};
}

}  // namespace arap::cli
