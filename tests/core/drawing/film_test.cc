#include "core/drawing/film.h"

#include <cmath>
#include <optional>
#include <string>

#include <gmock/gmock.h>

#include "core/drawing/reel.h"

namespace arap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

// Two triangles on the unit square.
const std::vector<Triangle> kSquare{{0, 1, 2}, {0, 2, 3}};
const std::vector<Complex> kCorners{{0, 0}, {1, 0}, {1, 1}, {0, 1}};

std::size_t Count(const std::string& text, const std::string& piece) {
  std::size_t count = 0;
  for (std::size_t at = text.find(piece); at != std::string::npos;
       at = text.find(piece, at + piece.size())) {
    ++count;
  }
  return count;
}

Film SquareFilm(std::size_t frames) {
  Film film;
  film.triangles = kSquare;
  film.caption = "a < b & c";
  for (std::size_t i = 0; i < frames; ++i) {
    film.shapes.push_back(kCorners);
    film.handles.push_back({{0.5, static_cast<double>(i)}});
    film.numbers.push_back(i);
  }
  return film;
}

// The box of all frames of SquareFilm.
Bounds BoxOf(const Film& film) {
  Bounds bounds;
  for (const auto& shape : film.shapes) bounds.Add(shape);
  for (const auto& handles : film.handles) bounds.Add(handles);
  return bounds;
}

TEST(Film, AnimationLoopsOverEveryFrame) {
  const Film film = SquareFilm(30);
  const std::string svg = FormatAnimation(film, 1, BoxOf(film));
  EXPECT_THAT(svg, HasSubstr("viewBox"));
  EXPECT_THAT(svg, HasSubstr("a &lt; b &amp; c"));
  EXPECT_EQ(Count(svg, "attributeName=\"d\" dur=\"1.00s\" repeatCount=\"indefinite\""), 2u);
  EXPECT_EQ(Count(svg, "<circle"), 1u);
  // 2 paths and 2 coordinates of one handle, 29 separators each.
  EXPECT_EQ(Count(svg, ";"), 4 * 29u + 2u);  // and those of the two escapes
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
}

TEST(Film, AHandleThatComesAndGoesHasNoSizeMeanwhile) {
  Film film = SquareFilm(3);
  const Complex none(NAN, NAN);
  film.handles = {{{0, 0}, none, none}, {{0, 0}, {1, 1}, none}, {{0, 0}, none, none}};
  const std::string svg = FormatAnimation(film, 1, BoxOf(film));
  EXPECT_EQ(Count(svg, "<circle"), 2u);  // the third is never there
  EXPECT_EQ(Count(svg, "attributeName=\"r\""), 1u);
  EXPECT_THAT(svg, HasSubstr("values=\"0;11;0\""));
  EXPECT_THAT(svg, HasSubstr("values=\"1040;1040;1040\""));  // it does not jump
  EXPECT_EQ(Count(FormatSheet(film), "<circle"), 4u);
}

// A reel of the frames of SquareFilm; where each goes is its number.
Reel ReelOf(std::size_t frames, std::optional<std::size_t> total) {
  Reel reel(kSquare, total);
  for (std::size_t i = 0; i < frames; ++i) {
    reel.Add(i, kCorners, {{0.5, static_cast<double>(i)}});
    EXPECT_LE(reel.kept_count(), Reel::kMostKept) << i;
  }
  EXPECT_EQ(reel.frame_count(), frames);
  return reel;
}

TEST(Reel, LongFilmsAreThinnedOut) {
  // Every twelfth of 1000 frames; the last of them is 996.
  Film expected = SquareFilm(0);
  for (std::size_t i = 0; i < 1000; i += 12) {
    expected.shapes.push_back(kCorners);
    expected.handles.push_back({{0.5, static_cast<double>(i)}});
  }
  EXPECT_EQ(expected.frame_count(), 84u);
  const Film all = SquareFilm(1000);
  EXPECT_EQ(ReelOf(1000, 1000).Animation(expected.caption),
            FormatAnimation(expected, 1000 / 30.0, BoxOf(all)));
}

TEST(Reel, ShortFilmsAreWhole) {
  const Film film = SquareFilm(90);
  for (const std::optional<std::size_t> total : {std::optional<std::size_t>(90), {}}) {
    EXPECT_EQ(ReelOf(90, total).Animation(film.caption), FormatAnimation(film, 3, BoxOf(film)));
  }
}

TEST(Reel, KeepsAFewFramesOfAFilmOfAnyLength) {
  const std::size_t frames = 100'000;
  const Reel known = ReelOf(frames, frames);
  EXPECT_LE(known.kept_count(), Reel::kMostAnimated + Reel::kMostOnSheet);
  const Reel unknown = ReelOf(frames, std::nullopt);
  EXPECT_LE(unknown.kept_count(), Reel::kMostKept);
  // Two paths, the handle's two coordinates; one separator fewer than frames in each.
  const std::size_t shown = Count(unknown.Animation("film"), ";") / 4 + 1;
  EXPECT_EQ(shown, frames / 2048 + 1);
  // More or fewer than were told.
  EXPECT_LE(ReelOf(10'000, 7).kept_count(), Reel::kMostKept);
  EXPECT_EQ(Count(ReelOf(10, 1000).Sheet("film"), "<circle"), 2u);  // 0 and 9
}

TEST(Reel, SheetHasFirstAndLastFrame) {
  EXPECT_THAT(Spread(120, 8), ElementsAre(0, 17, 34, 51, 68, 85, 102, 119));
  EXPECT_THAT(Spread(3, 8), ElementsAre(0, 1, 2));
  EXPECT_THAT(Spread(5, 1), ElementsAre(0));
  EXPECT_THAT(Spread(0, 8), ElementsAre());
  const std::string svg = ReelOf(12'000, 12'000).Sheet("film");
  EXPECT_EQ(Count(svg, "<circle"), 8u);
  for (const char* const number : {"frame 0<", "frame 1714<", "frame 11999<"}) {
    EXPECT_THAT(svg, HasSubstr(number));
  }
  const std::string unknown = ReelOf(12'000, std::nullopt).Sheet("film");
  EXPECT_EQ(Count(unknown, "<circle"), 8u);
  EXPECT_THAT(unknown, HasSubstr("frame 0<"));
  EXPECT_THAT(unknown, HasSubstr("frame 11999<"));
  EXPECT_EQ(Count(ReelOf(1, std::nullopt).Sheet("film"), "<circle"), 1u);
}

}  // namespace
}  // namespace arap
