#include "client/cli/stage.h"
#include "client/cli/text_file.h"

namespace arap::cli {

FilmMaker::FilmMaker(const StageOptions& options, const Stage& stage)
    : svg_(options.svg), frames_svg_(options.frames_svg), track_(stage.track()) {
  film_.triangles = stage.mesh().triangles;
}

void FilmMaker::Add(std::size_t frame, const client::Shape& shape) {
  if (svg_.empty() && frames_svg_.empty()) return;
  film_.shapes.push_back(shape.positions);
  film_.handles.push_back(track_.frames[frame].targets);
  film_.numbers.push_back(frame);
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
