// Texts put together with oddities: what the readers of meshes and lists are tried with, each oddity
// alone and in pairs.
#pragma once

#include <cstddef>
#include <functional>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "arap/model/mesh.h"

namespace arap::testing {

// A text under way. A word or line that begins with @ is written without it, and its first word is the
// one that a reader is expected to complain about.
struct Draft {
  std::vector<std::vector<std::string>> vertices, faces;  // the words of each; a list has no faces
  std::vector<std::string> before, between, after;        // whole lines
  std::string header = "OFF", behind_header = "\n";       // OFF only, as the counts
  std::vector<std::string> counts;
  std::string end = "\n";   // of a line
  std::string blank = " ";  // between words
  std::string joint;        // instead of the last blank of a line
  std::string tail;         // of the line of a vertex or a face
  bool byte_order_mark = false;
  bool last_end = true;  // whether the last line has an end
  bool faces_first = false;
  bool one_line = false;    // all vertices on one
  bool word_lines = false;  // each word has a line
};

struct DraftText {
  std::string text;
  std::size_t line = 0;  // that of the marked word; 0: there is none
  std::string word;
};

// A sheet in the xy plane, 20 × 10 with a notch in the upper side, of four triangles: two convex quads,
// which together are a concave hexagon.
Draft PlainObj();
Draft PlainOff();
std::vector<Point3> SheetVertices();
double SheetArea();

DraftText ObjText(const Draft& draft);
DraftText OffText(const Draft& draft);
// The vertices alone.
DraftText ListText(const Draft& draft);

// What is done to a draft, and what comes of it.
struct Oddity {
  const char* name;
  const char* group;  // two of the same do not go together
  std::function<void(Draft&)> change;
  const char* complaint = nullptr;  // a part of the sentence; none: it is read
  const char* warning = nullptr;    // the kind of the one that it draws
};
using Oddities = std::vector<Oddity>;

// What all texts have in common: byte order mark, line ends, blanks, comments.
Oddities TextOddities();
// Of the second number of every vertex, or of the only one.
Oddities NumberOddities();
// The second number of the third vertex, or the only one, is none: nan, a decimal comma, …
Oddities BadNumbers();
Oddities Joined(std::initializer_list<Oddities> parts);

// A draft with oddities, and what is to come of it.
struct Trial {
  Draft draft;
  const char* complaint = nullptr;
  std::vector<std::string> warnings;
  bool Has(const std::string& oddity) const;

  std::vector<std::string> names;
};

// Calls `check` with each oddity alone and with every two that go together, done to the plain draft in
// the order of the list: those that replace the faces come first, those that spoil a word last.
void TryAlonePaired(const Draft& plain, const Oddities& oddities,
                    const std::function<void(const Trial&)>& check);

}  // namespace arap::testing
