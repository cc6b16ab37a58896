#include "core/drawing/film.h"

#include <cmath>
#include <string>

#include <gmock/gmock.h>

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

TEST(Film, AnimationLoopsOverEveryFrameOfAShortFilm) {
  const std::string svg = FormatAnimation(SquareFilm(30));
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
  const std::string svg = FormatAnimation(film);
  EXPECT_EQ(Count(svg, "<circle"), 2u);  // the third is never there
  EXPECT_EQ(Count(svg, "attributeName=\"r\""), 1u);
  EXPECT_THAT(svg, HasSubstr("values=\"0;11;0\""));
  EXPECT_THAT(svg, HasSubstr("values=\"1040;1040;1040\""));  // it does not jump
  EXPECT_EQ(Count(FormatSheet(film, 8), "<circle"), 4u);
}

TEST(Film, LongFilmsAreThinnedOut) {
  const std::string svg = FormatAnimation(SquareFilm(1000));
  EXPECT_EQ(Count(svg, ";"), 4 * 83u + 2u);  // every twelfth of 1000 frames
}

TEST(Film, SheetHasFirstAndLastFrame) {
  EXPECT_THAT(Spread(120, 8), ElementsAre(0, 17, 34, 51, 68, 85, 102, 119));
  EXPECT_THAT(Spread(3, 8), ElementsAre(0, 1, 2));
  EXPECT_THAT(Spread(5, 1), ElementsAre(0));
  EXPECT_THAT(Spread(0, 8), ElementsAre());
  const std::string svg = FormatSheet(SquareFilm(120), 8);
  EXPECT_EQ(Count(svg, "<circle"), 8u);
  EXPECT_THAT(svg, HasSubstr("frame 119"));
  EXPECT_THAT(svg, HasSubstr("frame 0<"));
}

}  // namespace
}  // namespace arap
